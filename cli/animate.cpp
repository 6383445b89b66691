// wavefog animate: a range of frames of a scene whose fog moves.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <sstream>

#include "command.h"
#include "files.h"
#include "frame.h"
#include "interrupt.h"
#include "parallel.h"
#include "report.h"
#include "scene_options.h"

extern char** environ;

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

constexpr int kLastFrame = 9999999;

struct FrameRange {
    int first = 0, last = 0;
    int count() const { return last - first + 1; }
};

struct AnimateOptions {
    SceneOptions scene;
    fs::path output, video;
    FrameRange frames;
    double fps = 24;
    bool json = false;
};

/// "A-B" with A <= B, or one number.
Result<FrameRange> parse_frames(const std::string& text) {
    const auto bar = text.find('-');
    const auto first = parse_integer_in(text.substr(0, bar), 0, kLastFrame);
    const auto last =
        bar == std::string::npos ? first : parse_integer_in(text.substr(bar + 1), 0, kLastFrame);
    if (!first || !last)
        return usage_error(
            fmt::format("'{}' is no range of frames; write A-B, such as 0-239", text));
    if (*last < *first)
        return usage_error(
            fmt::format("'{}' ends before it begins; write the smaller frame first", text));
    return FrameRange{*first, *last};
}

Result<double> parse_fps(const std::string& text) {
    const auto fps = parse_number(text);
    if (!fps || !(*fps > 0)) return usage_error(fmt::format("'{}' must be a number above 0", text));
    return fps;
}

/// A file name around the one run of '#' that stands for the frame.
struct Pattern {
    fs::path directory;
    std::string before, after;
    std::size_t digits = 0;

    /// With more digits where the number needs them.
    fs::path file(int frame) const {
        return directory / fmt::format("{}{:0{}}{}", before, frame, digits, after);
    }
    /// The same for ffmpeg, in which % has a meaning.
    std::string for_ffmpeg() const {
        const auto escaped = [](const std::string& text) {
            std::string out;
            for (const char c : text) out += c == '%' ? "%%" : std::string(1, c);
            return out;
        };
        return escaped((directory / before).string()) + fmt::format("%0{}d", digits) +
               escaped(after);
    }
};

Result<Pattern> parse_pattern(const fs::path& file) {
    const std::string name = file.filename().string();
    const auto begin = name.find('#');
    const auto end = name.find_first_not_of('#', begin);
    if (begin == std::string::npos ||
        (end != std::string::npos && name.find('#', end) != std::string::npos))
        return usage_error(
            fmt::format("{}: the file's name needs one run of # for the frame's number; write such "
                        "as {}",
                        file.string(), (file.parent_path() / "frame_####.png").string()));
    const std::size_t digits = (end == std::string::npos ? name.size() : end) - begin;
    return Pattern{file.parent_path(), name.substr(0, begin),
                   end == std::string::npos ? "" : name.substr(end), digits};
}

/// Where the shell would find the program; empty if nowhere.
fs::path find_program(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::stringstream places(path ? path : "");
    for (std::string place; std::getline(places, place, ':');)
        if (const fs::path file = fs::path(place.empty() ? "." : place) / name;
            access(file.c_str(), X_OK) == 0 && fs::is_regular_file(file))
            return file;
    return {};
}

Result<void> check(const AnimateOptions& options, const Pattern& pattern) {
    if (auto ok = check_scene(options.scene); !ok) return ok;
    const auto inputs = options.scene.inputs();
    for (const int frame : {options.frames.first, options.frames.last})
        if (auto ok = check_output(pattern.file(frame), inputs, {".png", ".exr"}); !ok) return ok;
    if (options.video.empty()) return {};
    if (extension_of(options.output) != ".png")
        return usage_error(
            fmt::format("{}: --video needs frames as .png", options.output.string()));
    if (find_program("ffmpeg").empty())
        return data_error(
            "--video: there is no ffmpeg in PATH; install it (apt-get install ffmpeg), or leave "
            "--video out and make the film elsewhere");
    return check_output(options.video, inputs, {".mp4", ".mkv", ".webm", ".mov"});
}

/// Runs a program to its end, its standard input closed; its status, or -1 if it did not start.
int run_program(const fs::path& program, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program.string());
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    pid_t child = 0;
    const int failed =
        posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return -1;
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

Result<void> make_video(const AnimateOptions& options, const Pattern& pattern) {
    const HoldInterrupts hold;
    // ffmpeg chooses the format by the extension, so that stays at the end.
    fs::path temporary = options.video;
    temporary.replace_filename(fmt::format("{}.tmp-{}{}", options.video.stem().string(), getpid(),
                                           options.video.extension().string()));
    // Players want even sides and 4:2:0.
    const int status = run_program(
        find_program("ffmpeg"),
        {"-y", "-loglevel", "error", "-framerate", fmt::format("{}", options.fps), "-start_number",
         std::to_string(options.frames.first), "-i", pattern.for_ffmpeg(), "-frames:v",
         std::to_string(options.frames.count()), "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt",
         "yuv420p", temporary.string()});
    std::error_code code;
    if (status == 0) fs::rename(temporary, options.video, code);
    if (status == 0 && !code) return {};
    fs::remove(temporary, code);
    return data_error(fmt::format(
        "{}: ffmpeg ended with status {}; its message stands above. The frames are all written",
        options.video.string(), status));
}

Result<void> animate(const AnimateOptions& options) {
    const auto pattern = parse_pattern(options.output);
    if (!pattern) return tl::unexpected(pattern.error());
    if (auto ok = check(options, *pattern); !ok) return ok;
    const Result<Scene> scene = load_scene(options.scene);
    if (!scene) return tl::unexpected(scene.error());
    auto drawer = FrameDrawer::create(*scene, options.scene.context, options.scene.supersample);
    if (!drawer) return tl::unexpected(drawer.error());

    const auto start = std::chrono::steady_clock::now();
    std::string renderer;
    {
        Progress progress("animating", std::size_t(options.frames.count()));
        for (int frame = options.frames.first; frame <= options.frames.last; ++frame) {
            const Result<Frame> drawn = drawer->draw(frame / options.fps);
            if (!drawn) return tl::unexpected(drawn.error());
            const HoldInterrupts hold;
            if (auto ok = write_image(pattern->file(frame), drawn->colour); !ok) return ok;
            progress.update(std::size_t(frame - options.frames.first + 1));
            renderer = drawn->renderer;
        }
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (!options.video.empty())
        if (auto ok = make_video(options, *pattern); !ok) return ok;

    Facts facts = {{"wrote", pattern->file(options.frames.first).string()},
                   {"to", pattern->file(options.frames.last).string()},
                   {"frames", options.frames.count()},
                   {"fps", options.fps},
                   {"size", {scene->width, scene->height}},
                   {"method", scene->method.name()},
                   {"context", options.scene.context},
                   {"renderer", renderer},
                   {"seconds", seconds.count()}};
    if (!options.video.empty()) facts["video"] = options.video.string();
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_animate(CLI::App& root) {
    auto options = std::make_shared<AnimateOptions>();
    CLI::App* app = root.add_subcommand("animate", "Draw frames of a scene whose fog moves");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output,
                    "The frames to write, .png or .exr; a run of # stands for the number")
        ->required()
        ->type_name("DIR/frame_####.png");
    add_parsed(*app, "--frames", options->frames, parse_frames, "A-B",
               "First and last frame; frame N shows the time N / fps")
        ->required();
    add_parsed(*app, "--fps", options->fps, parse_fps, "N", "Frames a second (24)");
    app->add_option("--video", options->video, "Also make a film of the frames, by ffmpeg")
        ->type_name("OUT.mp4");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(Winds blow, particles drift and maps given as "images" change. A frame depends on its
number alone: any machine may draw any range, the files are the same.

Example: ten seconds, split in two
  wavefog animate data/scenes/drift.json --frames 0-119 -o out/frame_####.png
  wavefog animate data/scenes/drift.json --frames 120-239 -o out/frame_####.png)");
    return {app, [options] { return animate(*options); }};
}

}  // namespace wavefog::cli

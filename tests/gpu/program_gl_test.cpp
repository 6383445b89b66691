#include <algorithm>

#include "gl_support.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

const ShaderText vertex{GL_VERTEX_SHADER, "test.vert", "void main() { gl_Position = vec4(0); }\n"};

}  // namespace

TEST_CASE("a compiler log names the shader's file and line, across includes") {
    const Gl& gl = osmesa().gl();
    const auto program =
        build_program_from_text(gl, {vertex,
                                     {GL_FRAGMENT_SHADER, "broken.frag",
                                      "#include \"scene_noise.glsl\"\nout vec4 colour;\n"
                                      "void main() { colour = vec4(missing_name); }\n"}});
    REQUIRE_FALSE(program.has_value());
    CHECK(program.error().kind == ErrorKind::data);
    CHECK(contains(program.error().message, "shader broken.frag does not compile"));
    CHECK(contains(program.error().message, "broken.frag:3"));
    CHECK(contains(program.error().message, "missing_name"));

    // An error inside the included file is reported as that file's.
    const auto clash = build_program_from_text(
        gl, {{GL_FRAGMENT_SHADER, "clash.frag", "#include \"scene_noise.glsl\"\nvoid main() {}\n"}},
        {"vec4 no_such_type"});
    REQUIRE_FALSE(clash.has_value());
    CHECK(contains(clash.error().message, "scene_noise.glsl:"));
}

TEST_CASE("a linker log names the program's shaders") {
    const auto program = build_program_from_text(
        osmesa().gl(), {vertex,
                        {GL_FRAGMENT_SHADER, "asks.frag",
                         "in vec3 nobody_writes_this;\nout vec4 colour;\n"
                         "void main() { colour = vec4(nobody_writes_this, 1); }\n"}});
    REQUIRE_FALSE(program.has_value());
    CHECK(contains(program.error().message, "program test.vert + asks.frag does not link"));
}

TEST_CASE("includes are resolved once, wherever they are mentioned") {
    const auto twice = build_program_from_text(
        osmesa().gl(), {{GL_FRAGMENT_SHADER, "twice.frag",
                         "#include \"scene_noise.glsl\"\n  # include \"scene_noise.glsl\"\n"
                         "out vec4 colour;\nvoid main() { colour = scene_noise(vec3(1)); }\n"}});
    CHECK_MESSAGE(twice.has_value(), (twice ? "" : twice.error().message));

    const std::string text = shader_source("scene_terrain.frag");
    CHECK(contains(text, "vec4 scene_noise(vec3 p)"));
    CHECK_FALSE(contains(text, "#include"));
    CHECK(shader_source("no_such_file.frag").empty());
}

TEST_CASE("a missing include names the file and line that ask for it") {
    const auto program = build_program_from_text(
        osmesa().gl(),
        {{GL_FRAGMENT_SHADER, "a.frag", "\n#include \"nowhere.glsl\"\nvoid main() {}\n"}});
    REQUIRE_FALSE(program.has_value());
    CHECK(contains(program.error().message, "a.frag:2: includes \"nowhere.glsl\""));
}

TEST_CASE("defines come before the text") {
    const std::string text =
        "#if !defined(A) || B != 3\n#error no defines\n#endif\nvoid main() {}\n";
    const ShaderText shader{GL_FRAGMENT_SHADER, "d.frag", text};
    CHECK(build_program_from_text(osmesa().gl(), {shader}, {"A", "B 3"}).has_value());
    CHECK_FALSE(build_program_from_text(osmesa().gl(), {shader}).has_value());
}

TEST_CASE("an unknown shader file is a usage error") {
    const auto program = build_program(osmesa().gl(), "post_fullscreen.vert", "nothing.frag");
    REQUIRE_FALSE(program.has_value());
    CHECK(program.error().kind == ErrorKind::usage);
    CHECK(contains(program.error().message, "nothing.frag"));
    CHECK_FALSE(build_compute_program(osmesa().gl(), "nothing.comp").has_value());
}

TEST_CASE("compute programs run") {
    const Gl& gl = osmesa().gl();
    const auto program = build_program_from_text(
        gl,
        {{GL_COMPUTE_SHADER, "fill.comp",
          "layout(local_size_x = 4) in;\nlayout(std430, binding = 0) buffer Out { float v[]; };\n"
          "void main() { v[gl_GlobalInvocationID.x] = float(gl_GlobalInvocationID.x) * 0.5; }\n"}});
    REQUIRE_MESSAGE(program.has_value(), (program ? "" : program.error().message));
    const Buffer buffer =
        make_buffer(gl, GL_SHADER_STORAGE_BUFFER, 8 * sizeof(float), nullptr, GL_DYNAMIC_READ);
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
    gl.UseProgram(program->name());
    gl.DispatchCompute(2, 1, 1);
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    float values[8] = {};
    gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof values, values);
    for (int i = 0; i < 8; ++i) CHECK(values[i] == 0.5f * float(i));
}

TEST_CASE("every embedded scene and post shader compiles, and every file opens with its purpose") {
    const Gl& gl = osmesa().gl();
    const std::vector<std::string> files = shader_files();
    CHECK(std::is_sorted(files.begin(), files.end()));
    REQUIRE(std::count(files.begin(), files.end(), "post_fullscreen.vert") == 1);
    for (const std::string& file : files) {
        CAPTURE(file);
        const std::string text = shader_source(file);
        CHECK(text.starts_with("// "));
        CHECK_FALSE(contains(text, "#version"));
        // The others' defines belong to the tests of the fog pass.
        if (!file.starts_with("scene_") && !file.starts_with("post_")) continue;
        const bool is_vertex = file.ends_with(".vert") || contains(text, "gl_Position");
        const std::string body = file.ends_with(".glsl") ? text + "void main() {}\n" : text;
        const auto program = build_program_from_text(
            gl, {{GLenum(is_vertex ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER), file, body}});
        CHECK_MESSAGE(program.has_value(), (program ? "" : program.error().message));
    }
}

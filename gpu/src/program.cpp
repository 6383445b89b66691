// Shader programs from embedded files: includes, defines, and logs with file names.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "embedded_shaders.h"
#include "wavefog/gpu/objects.h"

namespace wavefog {

namespace {

const EmbeddedShader* find_shader(std::string_view name) {
    for (const EmbeddedShader& shader : embedded_shaders())
        if (shader.name == name) return &shader;
    return nullptr;
}

/// The name in `#include "name"`, empty for any other line.
std::string_view included_name(std::string_view line) {
    const auto skip_blanks = [&line] {
        while (!line.empty() && (line[0] == ' ' || line[0] == '\t')) line.remove_prefix(1);
    };
    skip_blanks();
    if (!line.starts_with("#")) return {};
    line.remove_prefix(1);
    skip_blanks();
    if (!line.starts_with("include")) return {};
    line.remove_prefix(7);
    skip_blanks();
    if (!line.starts_with("\"")) return {};
    line.remove_prefix(1);
    return line.substr(0, line.find('"'));
}

/// One shader being put together. `#line LINE FILE` marks carry an index into `files`, which is how
/// a driver's log finds its way back to file names.
struct Assembly {
    std::vector<std::string> files;
    std::string text;
    bool line_marks = true;
    std::string error;

    void mark(int line, std::size_t file) {
        if (line_marks) text += fmt::format("#line {} {}\n", line, file);
    }

    void add(std::string_view name, std::string_view body) {
        const std::size_t file = files.size();
        files.emplace_back(name);
        mark(1, file);
        int line_number = 0;
        while (!body.empty() && error.empty()) {
            const std::string_view line = body.substr(0, body.find('\n'));
            body.remove_prefix(std::min(line.size() + 1, body.size()));
            ++line_number;
            const std::string_view include = included_name(line);
            if (include.empty()) {
                text.append(line).push_back('\n');
                continue;
            }
            if (std::find(files.begin(), files.end(), include) == files.end()) {
                const EmbeddedShader* shader = find_shader(include);
                if (!shader) {
                    error = fmt::format(
                        "{}:{}: includes \"{}\", which is not among the embedded shaders; "
                        "add it to shaders/ or correct the name",
                        name, line_number, include);
                    return;
                }
                add(include, shader->text);
            }
            mark(line_number + 1, file);
        }
    }
};

/// "0:12(3): error" (Mesa) and "0(12) : error" (NVIDIA) become "fog_pass.frag:12(3): error".
std::string with_file_names(std::string_view log, const std::vector<std::string>& files) {
    std::string result;
    while (!log.empty()) {
        const std::string_view line = log.substr(0, log.find('\n'));
        log.remove_prefix(std::min(line.size() + 1, log.size()));
        std::size_t digits = 0, file = 0;
        while (digits < line.size() && digits < 6 &&
               std::isdigit(static_cast<unsigned char>(line[digits])))
            file = 10 * file + std::size_t(line[digits++] - '0');
        if (!result.empty()) result += '\n';
        if (digits > 0 && digits < line.size() && (line[digits] == ':' || line[digits] == '(') &&
            file < files.size())
            result.append(files[file]).append(line.substr(digits));
        else
            result.append(line);
    }
    return result;
}

class ShaderStage {
  public:
    ShaderStage(const Gl& gl, GLenum stage) : gl_(gl), name_(gl.CreateShader(stage)) {}
    ShaderStage(const ShaderStage&) = delete;
    ShaderStage& operator=(const ShaderStage&) = delete;
    ~ShaderStage() { gl_.DeleteShader(name_); }
    GLuint name() const { return name_; }

  private:
    const Gl& gl_;
    GLuint name_;
};

std::string shader_log(const Gl& gl, GLuint shader) {
    GLint length = 0;
    gl.GetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(std::size_t(std::max(length, 1)), '\0');
    GLsizei written = 0;
    gl.GetShaderInfoLog(shader, GLsizei(log.size()), &written, log.data());
    log.resize(std::size_t(written));
    return log;
}

std::string program_log(const Gl& gl, GLuint program) {
    GLint length = 0;
    gl.GetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(std::size_t(std::max(length, 1)), '\0');
    GLsizei written = 0;
    gl.GetProgramInfoLog(program, GLsizei(log.size()), &written, log.data());
    log.resize(std::size_t(written));
    return log;
}

Result<void> compile(const Gl& gl, GLuint shader, const ShaderText& source,
                     const std::vector<std::string>& defines) {
    Assembly assembly;
    assembly.text = "#version 450 core\n";
    for (const std::string& define : defines) assembly.text += "#define " + define + "\n";
    assembly.add(source.name, source.text);
    if (!assembly.error.empty()) return data_error(assembly.error);

    const char* text = assembly.text.c_str();
    gl.ShaderSource(shader, 1, &text, nullptr);
    gl.CompileShader(shader);
    GLint ok = GL_FALSE;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok != GL_TRUE)
        return data_error(fmt::format("shader {} does not compile:\n{}", source.name,
                                      with_file_names(shader_log(gl, shader), assembly.files)));
    return {};
}

Result<ShaderText> embedded(GLenum stage, const std::string& file) {
    const EmbeddedShader* shader = find_shader(file);
    if (!shader)
        return usage_error("shader \"" + file + "\" is not among the embedded files of shaders/");
    return ShaderText{stage, file, std::string(shader->text)};
}

}  // namespace

Result<Program> build_program_from_text(const Gl& gl, const std::vector<ShaderText>& shaders,
                                        const std::vector<std::string>& defines) {
    Program program(gl, gl.CreateProgram());
    std::string names;
    for (const ShaderText& source : shaders) {
        const ShaderStage stage(gl, source.stage);
        if (auto compiled = compile(gl, stage.name(), source, defines); !compiled)
            return tl::unexpected(compiled.error());
        // The stage lives on inside the program until it is linked.
        gl.AttachShader(program.name(), stage.name());
        names += (names.empty() ? "" : " + ") + source.name;
    }
    gl.LinkProgram(program.name());
    GLint ok = GL_FALSE;
    gl.GetProgramiv(program.name(), GL_LINK_STATUS, &ok);
    if (ok != GL_TRUE)
        return data_error(
            fmt::format("program {} does not link:\n{}", names, program_log(gl, program.name())));
    return program;
}

Result<Program> build_program(const Gl& gl, const std::string& vertex_file,
                              const std::string& fragment_file,
                              const std::vector<std::string>& defines) {
    const auto vertex = embedded(GL_VERTEX_SHADER, vertex_file);
    if (!vertex) return tl::unexpected(vertex.error());
    const auto fragment = embedded(GL_FRAGMENT_SHADER, fragment_file);
    if (!fragment) return tl::unexpected(fragment.error());
    return build_program_from_text(gl, {*vertex, *fragment}, defines);
}

Result<Program> build_compute_program(const Gl& gl, const std::string& compute_file,
                                      const std::vector<std::string>& defines) {
    const auto compute = embedded(GL_COMPUTE_SHADER, compute_file);
    if (!compute) return tl::unexpected(compute.error());
    return build_program_from_text(gl, {*compute}, defines);
}

std::string shader_source(const std::string& file) {
    const EmbeddedShader* shader = find_shader(file);
    if (!shader) return {};
    Assembly assembly;
    assembly.line_marks = false;
    assembly.add(shader->name, shader->text);
    return assembly.error.empty() ? assembly.text : std::string();
}

std::vector<std::string> shader_files() {
    std::vector<std::string> names;
    for (const EmbeddedShader& shader : embedded_shaders()) names.emplace_back(shader.name);
    return names;
}

}  // namespace wavefog

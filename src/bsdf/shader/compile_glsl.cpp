#include "bsdf/shader/compile_glsl.h"

#include "core/error.h"

#include <charconv>
#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <mutex>

namespace nacre::shader {
namespace {

/// The front end's "ERROR: 0:LINE: message" as "NAME:LINE: message", the first few of them.
[[noreturn]] void throw_log(const std::string& log, const std::string& name) {
  constexpr std::string_view mark = "ERROR: 0:";
  std::string text;
  int errors = 0;
  for (std::size_t at = log.find(mark); at != std::string::npos; at = log.find(mark, at)) {
    at += mark.size();
    const std::string line = log.substr(at, log.find('\n', at) - at);
    if (line.find("compilation terminated") != std::string::npos ||
        line.find("compilation errors") != std::string::npos)
      continue;
    int number = 0;
    std::from_chars(line.data(), line.data() + line.size(), number);
    const std::size_t colon = line.find(':');
    if (errors++ < 3)
      text += fmt::format("{}{}:{}:{}", text.empty() ? "" : "\n", name, number,
                          colon == std::string::npos ? line : line.substr(colon + 1));
  }
  throw Error(text.empty() ? fmt::format("{}: the shader does not compile: {}", name, log) : text);
}

/// Set up once, and left to the end of the process.
void start_front_end() {
  static std::once_flag once;
  std::call_once(once, [] { glslang::InitializeProcess(); });
}

} // namespace

std::vector<std::uint32_t> compile_glsl(const std::string& text, const std::string& name) {
  start_front_end();
  glslang::TShader shader(EShLangFragment);
  const char* const source = text.c_str();
  const int length = int(text.size());
  shader.setStringsWithLengths(&source, &length, 1);
  shader.setEnvInput(glslang::EShSourceGlsl, EShLangFragment, glslang::EShClientOpenGL, 410);
  shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_0);
  shader.setAutoMapLocations(true);
  constexpr auto messages = EShMessages(EShMsgDefault | EShMsgSpvRules);
  if (!shader.parse(GetDefaultResources(), 410, false, messages)) throw_log(shader.getInfoLog(), name);
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages) || !program.mapIO()) throw_log(program.getInfoLog(), name);
  glslang::SpvOptions options;
  options.generateDebugInfo = true; // lines, for messages at run time
  options.disableOptimizer = true;
  std::vector<std::uint32_t> words;
  spv::SpvBuildLogger logger;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangFragment), words, &logger, &options);
  if (words.empty())
    throw Error(fmt::format("{}: the shader does not compile: {}", name, logger.getAllMessages()));
  return words;
}

} // namespace nacre::shader

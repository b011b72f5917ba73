#include "bsdf/shader/compile_glsl.h"

#include "core/error.h"
#include "core/printable.h"

#include <charconv>
#include <exception>
#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <mutex>
#include <pthread.h>

namespace nacre::shader {
namespace {

/// Lines from here on are not the user's.
constexpr int line_after = 10'000'000;
/// The front end goes down an expression by recursion: room for one of shader::max_words.
constexpr std::size_t stack_bytes = std::size_t(512) << 20;

/// What the front end said of the lines that follow the user's.
std::string said_of_main(const std::string& message, const GlslText& glsl, const std::string& wanted) {
  if (message.find("syntax error") != std::string::npos)
    return fmt::format("{}:{}: the shader ends too early: a '}}' or ';' is missing", glsl.name,
                       glsl.last_line());
  if (message.find("'main'") != std::string::npos)
    return fmt::format("{}:{}: 'main' is not a name for a function here", glsl.name, glsl.line_of("main"));
  return fmt::format("{}:{}: expected a function '{}'", glsl.name, glsl.first_line, wanted);
}

/// The front end's "ERROR: 0:LINE: message" as "NAME:LINE: message", the first few of them.
[[noreturn]] void throw_log(const std::string& log, const GlslText& glsl, const std::string& wanted) {
  constexpr std::string_view mark = "ERROR: 0:", cycle = "Recursion detected:\n    ";
  if (const std::size_t at = log.find(cycle); at != std::string::npos) {
    const std::string function = log.substr(at + cycle.size(), log.find('(', at) - at - cycle.size());
    throw Error(fmt::format("{}:{}: the function {} calls itself, which GLSL does not allow", glsl.name,
                            std::max(glsl.line_of_function(function), glsl.first_line), function));
  }
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
    if (number >= line_after) {
      if (errors++ == 0) text = said_of_main(line, glsl, wanted);
      continue;
    }
    std::string what = colon == std::string::npos ? line : line.substr(colon + 1);
    if (what.find("memory exhausted") != std::string::npos) what = " nested too deeply";
    if (errors++ < 3) text += fmt::format("{}{}:{}:{}", text.empty() ? "" : "\n", glsl.name, number, what);
  }
  throw Error(printable(
      text.empty() ? fmt::format("{}:{}: the shader does not compile: {}", glsl.name, glsl.first_line, log)
                   : text));
}

/// Set up once, and left to the end of the process.
void start_front_end() {
  static std::once_flag once;
  std::call_once(once, [] { glslang::InitializeProcess(); });
}

std::vector<std::uint32_t> compile(const std::string& text, const GlslText& glsl, const std::string& wanted) {
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
  if (!shader.parse(GetDefaultResources(), 410, false, messages))
    throw_log(shader.getInfoLog(), glsl, wanted);
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages) || !program.mapIO()) throw_log(program.getInfoLog(), glsl, wanted);
  glslang::SpvOptions options;
  options.generateDebugInfo = true; // lines, for messages at run time
  options.disableOptimizer = true;
  std::vector<std::uint32_t> words;
  spv::SpvBuildLogger logger;
  glslang::GlslangToSpv(*program.getIntermediate(EShLangFragment), words, &logger, &options);
  if (words.empty())
    throw Error(fmt::format("{}:{}: the shader does not compile: {}", glsl.name, glsl.first_line,
                            logger.getAllMessages()));
  return words;
}

/// Runs f on a stack of stack_bytes; of its pages only those that are used are there.
template <class F>
void run_on_large_stack(F& f) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_t thread;
  const auto start = [](void* what) -> void* {
    (*static_cast<F*>(what))();
    return nullptr;
  };
  const int error = pthread_create(&thread, &attributes, start, &f);
  pthread_attr_destroy(&attributes);
  if (error) throw Error("no memory for the stack of the GLSL front end");
  pthread_join(thread, nullptr);
}

} // namespace

std::vector<std::uint32_t> compile_glsl(const std::string& before, const GlslText& glsl,
                                        const std::string& after, const std::string& wanted) {
  const std::string text = fmt::format("#version 410 core\n{}\n#line {}\n{}\n#line {}\n{}\n", before,
                                       glsl.first_line, glsl.text, line_after, after);
  std::vector<std::uint32_t> words;
  std::exception_ptr failure;
  auto work = [&] {
    try {
      words = compile(text, glsl, wanted);
    } catch (...) {
      failure = std::current_exception();
    }
  };
  run_on_large_stack(work);
  if (failure) std::rethrow_exception(failure);
  return words;
}

} // namespace nacre::shader

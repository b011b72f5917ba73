#include "bsdf/shader/glsl_text.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <utility>
#include <vector>

namespace nacre::shader {
namespace {

constexpr std::size_t max_bytes = 1 << 18, max_macros = 500;

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_part(char c) { return is_letter(c) || (c >= '0' && c <= '9'); }

std::string without_comments(std::string_view glsl) {
  std::string text(glsl);
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] != '/' || (text[i + 1] != '/' && text[i + 1] != '*')) continue;
    const bool line = text[i + 1] == '/';
    const std::size_t found = text.find(line ? "\n" : "*/", i + (line ? 1 : 2));
    if (found == std::string::npos && !line) break; // the front end says that the comment does not end
    const std::size_t end = found == std::string::npos ? text.size() : found + (line ? 0 : 2);
    for (; i < end; ++i)
      if (text[i] != '\n') text[i] = ' ';
    --i;
  }
  return text;
}

/// The word, number or sign that begins at `at`; a blank is one of no length.
std::string_view word_at(std::string_view text, std::size_t at) {
  if (text[at] == ' ' || text[at] == '\t' || text[at] == '\n' || text[at] == '\r') return {};
  std::size_t end = at + 1;
  if (is_part(text[at]))
    while (end < text.size() && is_part(text[end]))
      ++end;
  return text.substr(at, end - at);
}

/// f(word, place) for each.
template <class F>
void each_word(std::string_view text, F f) {
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view word = word_at(text, at);
    if (!word.empty()) f(word, at);
    at += std::max<std::size_t>(word.size(), 1);
  }
}

bool is_directive(std::string_view word) {
  constexpr std::array<std::string_view, 13> all{"define",    "undef",   "if",    "ifdef", "ifndef",
                                                 "else",      "elif",    "endif", "error", "pragma",
                                                 "extension", "version", "line"};
  return std::find(all.begin(), all.end(), word) != all.end();
}

/// Lines that go on in the next are joined, the line breaks following, so that numbers of lines stay. Lines
/// that begin with '#' and are no directives are blank: comments, as BRDF Explorer has it.
std::string with_whole_lines(const std::string& text) {
  std::string whole, breaks;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::size_t hash = line.find_first_not_of(" \t");
    if (breaks.empty() && hash != std::string_view::npos && line[hash] == '#') {
      const std::size_t word = line.find_first_not_of(" \t", hash + 1);
      if (!is_directive(word == std::string_view::npos ? "" : word_at(line, word))) line = {};
    }
    if (line.ends_with('\\')) {
      whole += line.substr(0, line.size() - 1);
      breaks += '\n';
    } else {
      whole += line;
      whole += '\n' + std::exchange(breaks, "");
    }
  }
  return whole + breaks;
}

/// An upper bound of the words that macros make of a text.
class Expansion {
public:
  void define(std::string_view directive) { // from the name on
    const std::string name(word_at(directive, 0));
    Macro m;
    std::size_t body = name.size();
    if (body < directive.size() && directive[body] == '(') {
      m.takes_arguments = true;
      const std::size_t end = std::min(directive.find(')', body), directive.size());
      each_word(directive.substr(body, end - body), [&](std::string_view word, std::size_t) {
        if (is_letter(word[0])) m.parameters.emplace_back(word);
      });
      body = std::min(end + 1, directive.size());
    }
    m.body = std::string(directive.substr(body));
    macros_[name].push_back(std::move(m)); // conditions are not looked at: each definition may hold
  }
  std::size_t count() const { return macros_.size(); }

  double words(std::string_view text) { return scan(text, nullptr).words; }

private:
  struct Macro {
    bool takes_arguments = false;
    std::vector<std::string> parameters;
    std::string body;
  };
  struct Weight {
    double words = 1;
    double copies = 1; ///< of an argument
    bool takes_arguments = false;
  };

  Weight scan(std::string_view text, const Macro* macro) {
    Weight total{0, 1, macro && macro->takes_arguments};
    std::map<std::string, double, std::less<>> uses;
    std::vector<std::pair<int, double>> calls; // depth of the parentheses of each call, copies made there
    double factor = 1;
    int depth = 0;
    double opens = 0; // copies of the argument list that comes next
    each_word(text, [&](std::string_view word, std::size_t) {
      if (word == "(") {
        ++depth;
        if (opens > 1) calls.emplace_back(depth, opens), factor *= opens;
      } else if (word == ")") {
        while (!calls.empty() && calls.back().first == depth)
          factor /= calls.back().second, calls.pop_back();
        --depth;
      }
      opens = 0;
      if (macro &&
          std::find(macro->parameters.begin(), macro->parameters.end(), word) != macro->parameters.end()) {
        total.copies = std::max(total.copies, uses[std::string(word)] += factor);
      } else if (const Weight* w = weight(word)) {
        total.words += factor * w->words;
        if (w->takes_arguments) opens = w->copies;
        return;
      }
      total.words += factor;
    });
    return total;
  }
  const Weight* weight(std::string_view name) {
    const auto found = macros_.find(name);
    if (found == macros_.end()) return nullptr;
    const auto [known, is_new] = weights_.try_emplace(std::string(name)); // a macro in itself stays as it is
    if (is_new) {
      Weight most;
      for (const Macro& m : found->second) {
        const Weight w = scan(m.body, &m);
        most = {std::max(most.words, w.words), std::max(most.copies, w.copies),
                most.takes_arguments || w.takes_arguments};
      }
      known->second = most;
    }
    return &known->second;
  }

  std::map<std::string, std::vector<Macro>, std::less<>> macros_;
  std::map<std::string, Weight, std::less<>> weights_;
};

bool is_texture(std::string_view word) {
  if (word.starts_with("i") || word.starts_with("u")) word.remove_prefix(word.starts_with("image") ? 0 : 1);
  return word.starts_with("sampler") || word.starts_with("image1D") || word.starts_with("image2D") ||
         word.starts_with("image3D") || word.starts_with("imageCube") || word.starts_with("imageBuffer");
}

} // namespace

GlslText::GlslText(std::string_view glsl, std::string_view file, int line)
    : text(with_whole_lines(without_comments(glsl.substr(0, max_bytes)))), name(file), first_line(line) {
  const auto fail = [&](int at, const std::string& what) {
    throw Error(fmt::format("{}:{}: {}", name, at, what));
  };
  if (glsl.size() > max_bytes)
    fail(first_line, fmt::format("a shader of {} bytes, longer than {}", glsl.size(), max_bytes));
  Expansion macros;
  std::string rest; // without directives
  int number = first_line;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view one = std::string_view(text).substr(begin, end - begin);
    const std::size_t hash = one.find_first_not_of(" \t");
    if (hash != std::string_view::npos && one[hash] == '#') {
      const std::size_t word = one.find_first_not_of(" \t", hash + 1);
      const std::string_view directive = word == std::string_view::npos ? "" : word_at(one, word);
      if (directive == "line") fail(number, "#line is not supported: lines are those of the file");
      if (directive == "define") {
        const std::size_t at = one.find_first_not_of(" \t", word + directive.size());
        if (at != std::string_view::npos) macros.define(one.substr(at));
      }
    } else {
      each_word(one, [&](std::string_view w, std::size_t) {
        if (w == "double" || w.starts_with("dvec") || w.starts_with("dmat"))
          fail(number, fmt::format("'{}': double precision is not supported: use float", w));
        if (is_texture(w)) fail(number, fmt::format("'{}': textures are not supported", w));
      });
      rest += one;
      rest += '\n';
    }
    begin = end + 1;
  }
  if (macros.count() > max_macros)
    fail(first_line, fmt::format("{} macros, more than {}", macros.count(), max_macros));
  if (const double words = macros.words(rest); !(words <= max_words))
    fail(first_line,
         fmt::format("a shader of {:.3g} words, its macros expanded, longer than {:g}", words, max_words));
}

int GlslText::last_line() const {
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  return first_line +
         int(std::count(text.begin(), text.begin() + std::ptrdiff_t(last == std::string::npos ? 0 : last),
                        '\n'));
}

int GlslText::line_of(std::string_view word) const {
  int line = 0;
  each_word(text, [&](std::string_view w, std::size_t at) {
    if (line == 0 && w == word)
      line = first_line + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
  });
  return line;
}

int GlslText::line_of_function(std::string_view function) const {
  int line = 0;
  each_word(text, [&](std::string_view w, std::size_t at) {
    if (line != 0 || w != function) return;
    const std::size_t body = text.find_first_of("{;", at);
    if (body != std::string::npos && text[body] == '{')
      line = first_line + int(std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'));
  });
  return line ? line : line_of(function);
}

} // namespace nacre::shader

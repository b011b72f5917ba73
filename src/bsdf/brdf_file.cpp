#include "bsdf/brdf_file.h"

#include "core/error.h"
#include "core/file.h"
#include "core/printable.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace nacre {
namespace {

struct Word {
  std::string_view text;
  int column;
};

std::vector<Word> words_of(std::string_view line) {
  std::vector<Word> words;
  constexpr std::string_view blank = " \t\r";
  for (std::size_t at = line.find_first_not_of(blank); at != std::string_view::npos;
       at = line.find_first_not_of(blank, at)) {
    const std::size_t end = std::min(line.find_first_of(blank, at), line.size());
    words.push_back({line.substr(at, end - at), int(at) + 1});
    at = end;
  }
  return words;
}

bool is_identifier(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && letter(name[0]) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

class Reader {
public:
  Reader(std::string_view text, std::string_view name) : rest_(text), name_(name) {
    file_.name = std::string(name);
  }

  BrdfFile read() {
    bool has_kind = false, has_shader = false;
    std::string other; // what stands where a shader might, and is none
    if (rest_.size() > max_brdf_bytes)
      fail(1, fmt::format("{} bytes, more than the {} of a .brdf file", rest_.size(), max_brdf_bytes));
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3); // some editors begin UTF-8 so
    while (next()) {
      const auto words = words_of(line_);
      if (words.empty() || words[0].text[0] == '#') continue;
      if (!has_kind) {
        if (words[0].text != "analytic" && words[0].text != "bparam")
          fail(words[0].column, fmt::format("expected 'analytic', the first word of a .brdf file, found '{}'",
                                            quoted(words[0].text)));
        has_kind = true;
        continue;
      }
      if (words[0].text != "::begin" || words.size() < 2) {
        if (other.empty()) other = fmt::format("; line {} has '{}'", line_number_, quoted(words[0].text));
        continue;
      }
      const std::string section(words[1].text);
      if (section == "parameters") {
        read_parameters();
      } else if (section == "shader") {
        if (has_shader) fail(1, "a second shader");
        has_shader = true;
        file_.shader_line = line_number_ + 1;
        file_.shader = section_text("shader");
      } else {
        // Sampling for graphics cards, and what other programs keep there; Nacre samples by the values
        // themselves.
        other = fmt::format("; line {} has '::begin {}'", line_number_, quoted(section));
        section_text(section);
      }
    }
    if (!has_kind) fail(1, "empty: expected 'analytic', the first word of a .brdf file");
    if (!has_shader) fail(1, "no '::begin shader': a .brdf file needs a shader" + other);
    return std::move(file_);
  }

private:
  static std::string quoted(std::string_view text) { return printable(text.substr(0, 40)); }
  [[noreturn]] void fail(int column, const std::string& what) const {
    throw Error::in_text(name_, std::max(line_number_, 1), column, what);
  }
  bool next() {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_number_;
    return true;
  }
  bool at_end_of(const std::string& section) {
    const auto words = words_of(line_);
    return words.size() >= 1 && words[0].text == "::end" && (words.size() < 2 || words[1].text == section);
  }
  std::string section_text(const std::string& section) {
    const int begin = line_number_;
    std::string text;
    while (next()) {
      if (at_end_of(section)) return text;
      text += std::string(line_) + "\n";
    }
    line_number_ = begin;
    fail(1, fmt::format("'::begin {0}' without '::end {0}'", quoted(section)));
  }

  double number(const Word& word) const {
    std::string_view text = word.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    if (text.ends_with('f')) text.remove_suffix(1);
    double x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x) || std::abs(x) > 1e30)
      fail(word.column, fmt::format("expected a number, found '{}'", quoted(word.text)));
    return x;
  }

  void read_parameters() {
    const int begin = line_number_;
    while (next()) {
      if (at_end_of("parameters")) return;
      const auto words = words_of(line_.substr(0, line_.find('#')));
      if (words.empty()) continue;
      using Form = BrdfFile::Parameter::Form;
      BrdfFile::Parameter p;
      const std::string_view form = words[0].text;
      const std::size_t numbers = form == "float" || form == "color" ? 3 : form == "bool" ? 1 : 0;
      if (numbers == 0) {
        const std::vector<std::string> known{"float", "bool", "color"};
        fail(words[0].column, fmt::format("unknown type '{}'{}", quoted(form), suggestion(form, known)));
      }
      // Words after the numbers say nothing to us.
      if (words.size() < 2 + numbers)
        fail(words[0].column, fmt::format("expected '{}', found {} words",
                                          form == "float"  ? "float NAME MIN MAX DEFAULT"
                                          : form == "bool" ? "bool NAME 0|1"
                                                           : "color NAME R G B",
                                          words.size()));
      p.name = std::string(words[1].text);
      p.line = line_number_;
      if (!is_identifier(p.name) || p.name.starts_with("gl_"))
        fail(words[1].column, fmt::format("'{}' is no name of a GLSL variable", quoted(p.name)));
      for (const auto& other : file_.parameters)
        if (other.name == p.name)
          fail(words[1].column,
               fmt::format("a second parameter '{}', the first is in line {}", quoted(p.name), other.line));
      if (form == "float") {
        p.form = Form::number;
        p.lo = number(words[2]), p.hi = number(words[3]);
        const double initial = number(words[4]);
        if (!(p.lo <= p.hi))
          fail(words[2].column, fmt::format("the range [{}, {}] of {} is empty", p.lo, p.hi, quoted(p.name)));
        // A few published files begin outside their own range.
        p.lo = std::min(p.lo, initial), p.hi = std::max(p.hi, initial);
        p.initial.fill(initial);
      } else if (form == "bool") {
        p.form = Form::truth;
        p.initial.fill(number(words[2]) != 0 ? 1 : 0);
      } else {
        p.form = Form::color;
        for (std::size_t c = 0; c < 3; ++c)
          p.initial[c] = number(words[2 + c]);
        p.lo = std::min({0.0, p.initial[0], p.initial[1], p.initial[2]});
        p.hi = std::max({1.0, p.initial[0], p.initial[1], p.initial[2]});
      }
      file_.parameters.push_back(std::move(p));
    }
    line_number_ = begin;
    fail(1, "'::begin parameters' without '::end parameters'");
  }

  std::string_view rest_, line_, name_;
  int line_number_ = 0;
  BrdfFile file_;
};

} // namespace

BrdfFile parse_brdf_file(std::string_view text, std::string_view name) { return Reader(text, name).read(); }

std::string read_brdf_text(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto kind = fs::status(path, error).type();
  // What is not there, or a folder, has its message below.
  if (kind != fs::file_type::regular && kind != fs::file_type::not_found && kind != fs::file_type::directory)
    throw Error::in_file(path, "is no plain file");
  if (const auto size = fs::file_size(path, error); !error && size > max_brdf_bytes)
    throw Error::in_file(path,
                         fmt::format("{} bytes, more than the {} of a .brdf file", size, max_brdf_bytes));
  return read_text_file(path);
}

} // namespace nacre

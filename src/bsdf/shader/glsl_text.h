#pragma once
// What is asked of a shader's text before the front end reads it: that reading it ends, in bounded memory,
// and that the lines of its messages are those of the user's file.

#include <string>
#include <string_view>

namespace nacre::shader {

/// Words of a shader after its macros are expanded, at most.
inline constexpr double max_words = 1e5;

/// A user's GLSL in the lines of a file.
struct GlslText {
  std::string text; ///< comments are blanks, lines are where they were
  std::string name; ///< of the file
  int first_line = 1;

  /// @throws Error with the line for a #line directive, a type that the machine lacks, or a text that is too
  /// long or grows too long by its macros
  GlslText(std::string_view glsl, std::string_view file, int line);

  int last_line() const;
  /// Of the first place where the word stands; 0: nowhere.
  int line_of(std::string_view word) const;
  /// Of the function's body, or of its first mention; 0: nowhere.
  int line_of_function(std::string_view function) const;
};

} // namespace nacre::shader

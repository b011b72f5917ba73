// Models that a user wrote in GLSL: values, derivatives, and what ends a shader that cannot run.
#include "bsdf/user_model.h"

#include "bsdf/reference_table.h"
#include "bsdf/user_shader.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/random.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

namespace nacre {
namespace {

using namespace user_shader;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const Vec3d wo = spherical_direction(0.4, 0.3), wi = spherical_direction(0.7, 2.0);

constexpr const char* public_files[] = {
    "ashikhman_shirley.brdf", "compare.brdf", "cooktorrance.brdf", "d_ggx.brdf", "disney.brdf", "ward.brdf"};

std::string public_file(const std::string& name) {
  const std::string path = std::string(NACRE_SOURCE_DIR) + "/../shared/data/brdf/" + name;
  return std::filesystem::exists(path) ? read_text_file(path) : "";
}

/// Relative error of their floats: some hundred roundings, and where a file has GGX facets of this alpha,
/// what cos^2 (alpha^2 - 1) + 1, a difference of numbers near 1, makes of eight.
double rounding(std::string_view file, const Vec3d& wm) {
  const double alpha = file == "compare.brdf" ? 0.02 : file == "d_ggx.brdf" ? 0.1 : 1;
  return 2e-5 + 2 * 8 * 6e-8 / (wm.z * wm.z * (alpha * alpha - 1) + 1);
}

TEST(UserModel, PublicFilesHaveTheValuesOfAGraphicsDriver) {
  int rows = 0;
  for (const char* name : public_files) {
    const std::string text = public_file(name);
    if (text.empty()) GTEST_SKIP() << "no public .brdf files beside the project";
    const auto model = UserModel::parse(text, name);
    const auto values = initial<double>(*model);
    for (const auto& row : reference_table::read("brdf_files.csv", name)) {
      const auto f = model->eval<double>(values, row.wo, row.wi);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(f[c], row.f[std::size_t(c)],
                    rounding(name, normalize(row.wo + row.wi)) * std::abs(row.f[std::size_t(c)]) + 1e-7)
            << row.text();
      ++rows;
    }
  }
  EXPECT_EQ(rows, 150);
}

struct Feature {
  const char* glsl; ///< a file's shader, or statements that return a vec3
  std::function<double(const Vec3d& L, const Vec3d& V)> red;
};

TEST(UserModel, TheLanguageMeansWhatGlslSays) {
  const std::vector<Feature> features{
      {"return vec3(L.z * V.x, 0, 0);", [](auto L, auto V) { return L.z * V.x; }},
      {"vec3 s = L.zyx; s.xy = V.yx; return s.yyy;", [](auto, auto V) { return V.x; }},
      {"vec3 s = L; s.zx += vec2(2, 1); return vec3(s.x - s.z);", [](auto L, auto) { return L.x - L.z - 1; }},
      {"float s = 0.0; for (int i = 1; i <= 5; ++i) s += float(i) * L.z; return vec3(s);",
       [](auto L, auto) { return 15 * L.z; }},
      {"float s = 1.0; int i = 0; while (i < 10) { if (i == 3) { i += 2; continue; } if (i > 7) break; s *= "
       "1.0 + L.z; i++; } return vec3(s);",
       [](auto L, auto) { return std::pow(1 + L.z, 6); }},
      {"float s = L.z; do { s *= 0.5; } while (s > 0.1); return vec3(s);",
       [](auto L, auto) {
         double s = L.z;
         do
           s *= 0.5;
         while (s > 0.1);
         return s;
       }},
      {"if (L.x > V.x) return vec3(1); else if (L.y > 0.0) return vec3(2, 0, 0); return vec3(3);",
       [](auto L, auto V) { return L.x > V.x ? 1.0
                                   : L.y > 0 ? 2.0
                                             : 3.0; }},
      {"return vec3(L.z > 0.5 && V.z < 0.5 || on ? 0.25 : 0.75);",
       [](auto L, auto V) { return L.z > 0.5 && V.z < 0.5 ? 0.25 : 0.75; }},
      {"return vec3(pow(L.z, 2.5) + exp(-V.z) + log(L.z) + exp2(V.x) + log2(V.z) + sqrt(L.z) + "
       "inversesqrt(V.z));",
       [](auto L, auto V) {
         return std::pow(L.z, 2.5) + std::exp(-V.z) + std::log(L.z) + std::exp2(V.x) + std::log2(V.z) +
                std::sqrt(L.z) + 1 / std::sqrt(V.z);
       }},
      {"return vec3(acos(L.z) + asin(V.x) + atan(L.y) + atan(L.y, L.x) + sin(V.z) + cos(L.z) + tan(V.x));",
       [](auto L, auto V) {
         return std::acos(L.z) + std::asin(V.x) + std::atan(L.y) + std::atan2(L.y, L.x) + std::sin(V.z) +
                std::cos(L.z) + std::tan(V.x);
       }},
      {"return vec3(mix(L.z, V.z, 0.3) + clamp(3.0 * L.z, 0.0, 1.0) + smoothstep(0.2, 1.2, V.z) + step(0.5, "
       "L.z) + min(L.x, V.x) + max(L.y, V.y));",
       [](auto L, auto V) {
         const double s = std::clamp((V.z - 0.2) / 1.0, 0.0, 1.0);
         return 0.7 * L.z + 0.3 * V.z + std::min(3 * L.z, 1.0) + s * s * (3 - 2 * s) + (L.z < 0.5 ? 0 : 1) +
                std::min(L.x, V.x) + std::max(L.y, V.y);
       }},
      {"return vec3(floor(-1.5 + L.z) + ceil(V.z) + fract(7.3 * L.z) + mod(-V.z, 0.3) + abs(L.x) + "
       "sign(L.x));",
       [](auto L, auto V) {
         const double m = -V.z - 0.3 * std::floor(-V.z / 0.3), x = 7.3 * L.z;
         return std::floor(-1.5 + L.z) + std::ceil(V.z) + x - std::floor(x) + m + std::abs(L.x) +
                (L.x > 0 ? 1 : -1);
       }},
      {"return vec3(length(L + V) + distance(L, V) + dot(cross(L, V), Y) + reflect(-L, N).x + "
       "normalize(L + V).z);",
       [](auto L, auto V) {
         return length(L + V) + length(L - V) + cross(L, V).y + L.x * -1.0 + normalize(L + V).z;
       }},
      {"mat3 m = mat3(X, V, N); vec3 r = m * L; vec3 q = L * m; return vec3(r.x + q.y + transpose(m)[0][1]);",
       [](auto L, auto V) { return L.x + V.x * L.y + dot(L, V) + V.x; }},
      {"mat2 m = mat2(L.x, 1, 2, V.z); return vec3(determinant(m) + (inverse(m) * m)[1][1] + (m * m)[0][0]);",
       [](auto L, auto V) { return L.x * V.z - 2 + 1 + L.x * L.x + 2; }},
      {"float w[4] = float[4](1.0, 2.0, 4.0, 8.0); float s = 0.0; for (int i = 0; i < 4; i++) s += w[i] * "
       "L[i % 3]; return vec3(s);",
       [](auto L, auto) { return 9 * L.x + 2 * L.y + 4 * L.z; }},
      {"int k = L.z > 0.5 ? 1 : 2; float w[3]; w[0] = 0.0; w[1] = 0.0; w[2] = 0.0; w[k] = V.z; return "
       "vec3(w[1] - w[2]);",
       [](auto L, auto V) { return L.z > 0.5 ? V.z : -V.z; }},
      {"switch (int(4.0 * L.z)) { case 0: return vec3(1); case 3: return vec3(0.3); default: break; } return "
       "vec3(0.5);",
       [](auto L, auto) { return int(4 * L.z) == 3   ? 0.3
                                 : int(4 * L.z) == 0 ? 1
                                                     : 0.5; }},
      {"int i = 7; i = (i << 2) % 5 ^ 6; uint u = 3000000000u; return vec3(float(i) + float(u / 1000000000u) "
       "+ "
       "float(-7 / 2));",
       [](auto, auto) { return double((28 % 5) ^ 6) + 3 - 3; }},
      {"bvec3 b = greaterThan(L, V); return vec3(any(b) ? 1.0 : 0.0, all(b), !on);",
       [](auto L, auto V) { return L.x > V.x || L.y > V.y || L.z > V.z ? 1.0 : 0.0; }},
      {"return tone.bgr * a;", [](auto, auto) { return 0.3; }},
      {"struct Lobe { float w; vec3 d; }; Lobe l = Lobe(2.0, V); l.d.x += 1.0; return l.w * l.d;",
       [](auto, auto V) { return 2 * (V.x + 1); }},
      {"const float PI = 3.0; const vec3 ks[2] = vec3[2](vec3(1), vec3(2)); float seen = 0.0;\n"
       "float twice(float x) { seen += 1.0; return 2.0 * x; }\n"
       "float twice(vec2 v) { return twice(v.x + v.y); }\n"
       "void split(in float x, out float whole, inout float sum) { whole = floor(x); sum += x; }\n"
       "#define SQR(x) ((x) * (x))\n"
       "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { float w, s = 1.0; split(3.5, w, s);\n"
       "  float y = twice(L.xy) + twice(V.z); return vec3(PI * y + w + s + seen + SQR(L.z)) * ks[1]; }",
       [](auto L, auto V) { return 2 * (3 * (2 * (L.x + L.y) + 2 * V.z) + 3 + 4.5 + 2 + L.z * L.z); }},
      {"return vec3(isnan(0.0 / (L.z - L.z)) ? 1.0 : 0.0);", [](auto, auto) { return 1.0; }},
      // Undefined in GLSL; graphics drivers multiply where the text says how often.
      {"const float two = 2.0; return vec3(pow(L.z - 2.0, two) + pow(L - 3.0, vec3(3, 1, 0)).x + pow(-V.z, "
       "5.0) + "
       "pow(L.z - 1.5, 8.0) + pow(L.z - 2.0, 0.0) + pow(-V.z, 1.0));",
       [](auto L, auto V) {
         return std::pow(L.z - 2, 2) + std::pow(L.x - 3, 3) + std::pow(-V.z, 5) + std::pow(L.z - 1.5, 8) + 1 -
                V.z;
       }},
      {"float to(float x, float n) { return pow(x, n); }\n"
       "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { float n = 2.0; float m = 2.0; if (L.z > V.z) m = "
       "2.5;\n"
       "  return vec3(to(-L.z, 3.0) + pow(-V.z, n) + pow(V.z, m) + to(0.0, 2.0)); }",
       [](auto L, auto V) {
         return -std::pow(L.z, 3) + std::pow(V.z, 2) + std::pow(V.z, L.z > V.z ? 2.5 : 2.0);
       }},
      {"int e; float s = frexp(10.0 * L.z, e); ivec2 k; vec2 t = frexp(vec2(-0.3 * V.z, 0.0), k);\n"
       "return vec3(s + float(e) + 3.0 * t.x + 5.0 * float(k.x) + t.y + float(k.y) + ldexp(V.z, -3) + "
       "ldexp(L.z, e));",
       [](auto L, auto V) {
         int e, k;
         const double s = std::frexp(10 * L.z, &e), t = std::frexp(-0.3 * V.z, &k);
         return s + e + 3 * t + 5 * k + V.z / 8 + std::ldexp(L.z, e);
       }},
      {"float n = 0.0; for (int i = 0; i < 3; ++i) n += 1.0; return vec3(pow(L.z, n));",
       [](auto L, auto) { return std::pow(L.z, 3); }},
      {"return vec3(pow(L.z - 2.0, 2.5) + pow(L.z - 2.0, 4.0 * a) + pow(L.z - 2.0, 9.0) + 0.5);",
       [](auto, auto) { return 0.5; }}, // undefined in GLSL: 0 here
  };
  for (const Feature& f : features)
    for (const auto& [o, i] : {std::pair{wo, wi}, {wi, wo}, {spherical_direction(1.2, -2.0), wi}}) {
      const bool whole = std::string(f.glsl).find("BRDF") != std::string::npos;
      const double expected = f.red(i, o);
      EXPECT_NEAR(value(whole ? file(f.glsl) : body(f.glsl), o, i)[0], expected,
                  1e-6 * (std::abs(expected) + 1)) // literals are float
          << f.glsl;
    }
}

TEST(UserModel, ReflectsNothingFromBelow) {
  const std::string one = body("return vec3(1);");
  EXPECT_EQ(value(one, wo, wi)[0], 1);
  EXPECT_EQ(value(one, wo, {wi.x, wi.y, -wi.z})[0], 0);
  EXPECT_EQ(value(one, {wo.x, wo.y, -wo.z}, wi)[0], 0);
}

TEST(UserModel, ErrorsOfCompilingNameTheLineOfTheFile) {
  EXPECT_THAT(message(body("float s = 1.0\nreturn vec3(s);")), StartsWith("t.brdf:11:"));
  EXPECT_THAT(message(body("\n\nreturn vec3(b);")), AllOf(StartsWith("t.brdf:12:"), HasSubstr("undeclared")));
  EXPECT_THAT(message(body("a = 1.0; return L;")), StartsWith("t.brdf:10:"));
  EXPECT_THAT(message(body("return 1.0;")), StartsWith("t.brdf:10:"));
  EXPECT_THAT(message(body("double d = 1.0; return L * float(d);")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("use float")));
  EXPECT_THAT(message(body("return dFdx(L);")), AllOf(StartsWith("t.brdf:10:"), HasSubstr("not supported")));
  EXPECT_THAT(message(body("float t[2] = float[2](1.0, 2.0);\nreturn vec3(t[2]);")),
              AllOf(StartsWith("t.brdf:11:"), HasSubstr("out of range")));
  EXPECT_THAT(message(file("// comment\nuniform sampler2D s;")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("textures are not supported")));
  EXPECT_THAT(message(file("\nuniform float more;\n" + std::string(signature) + " { return L * more; }")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("'more' is no parameter of the file")));
  EXPECT_THAT(message(file("#line 500\n" + std::string(signature) + " { return 1; }")),
              AllOf(StartsWith("t.brdf:9:"), HasSubstr("#line is not supported")));
}

TEST(UserModel, AFileWithoutItsFunctionIsToldWhichOneIsMissing) {
  for (const char* shader :
       {"vec3 brdf(vec3 L) { return L; }", "vec3 BRDF(vec3 L, vec3 V) { return L; }", ""})
    EXPECT_THAT(message(file(shader)),
                AllOf(StartsWith("t.brdf:9:"), HasSubstr(std::string("expected a function '") + signature)));
  EXPECT_THAT(message(file(std::string(signature) + "\n{\n  return L;\n")),
              AllOf(StartsWith("t.brdf:11:"), HasSubstr("ends too early")));
  EXPECT_THAT(message(file(std::string(signature) + "{ return L; }\nvoid main() {}")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("'main'")));
}

TEST(UserModel, WhatDoesNotEndIsEndedWithItsLine) {
  EXPECT_THAT(message(body("float s = 0.0;\nwhile (s >= 0.0)\n  s += L.z;\nreturn vec3(s);")),
              AllOf(StartsWith("t.brdf:12:"), HasSubstr("a loop does not end")));
  EXPECT_THAT(message(body("for (;;) {}\nreturn L;")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("does not end")));
  EXPECT_THAT(
      message(file("float f(float x);\nfloat g(float x) { return f(x); }\nfloat f(float x) {\n  return x > "
                   "1.0 ? g(x - 1.0) : x;\n}\n" +
                   std::string(signature) + " { return vec3(f(L.z)); }")),
      AllOf(StartsWith("t.brdf:11:"), HasSubstr("calls itself")));
}

TEST(UserModel, AnIndexOutsideItsArrayIsAnErrorWithItsLine) {
  const std::string array =
      "float t[3] = float[3](1.0, 2.0, 3.0);\nint i = int(OFFSET + 2.0 * L.z);\nreturn vec3(t[i]);";
  const auto with = [&](const char* offset) {
    std::string text = array;
    return body(text.replace(text.find("OFFSET"), 6, offset));
  };
  EXPECT_EQ(message(with("0.0")), "no error");
  EXPECT_THAT(message(with("3.0")),
              AllOf(StartsWith("t.brdf:12:"), HasSubstr("index 4 outside an array of 3")));
  EXPECT_THAT(message(with("-9.0")), AllOf(StartsWith("t.brdf:12:"), HasSubstr("index -7 outside")));
  // Where nobody goes, nothing fails.
  EXPECT_EQ(
      message(body(
          "float t[3] = float[3](1.0, 2.0, 3.0); int i = 7;\nif (L.z < 0.0) return vec3(t[i]);\nreturn L;")),
      "no error");
}

TEST(UserModel, TextsThatWouldExhaustTheFrontEndAreRefused) {
  const auto repeated = [](const std::string& text, int n) {
    std::string all;
    for (int i = 0; i < n; ++i)
      all += text;
    return all;
  };
  EXPECT_THAT(message(body("return vec3(" + repeated("(", 20000) + "1.0" + repeated(")", 20000) + ");")),
              HasSubstr("t.brdf:10: nested too deeply"));
  EXPECT_THAT(message(body("float x = 1.0" + repeated("+1.0", 40000) + "; return vec3(x);")),
              HasSubstr("words"));
  EXPECT_EQ(message(body("float x = 1.0" + repeated("+x", 20) + "; return vec3(x);")).substr(0, 9),
            "t.brdf:10");
  EXPECT_EQ(message(body("float y = L.z; float x = y" + repeated("+y", 20000) + "; return vec3(x);")),
            "no error");
  EXPECT_THAT(message(body(repeated("int i;", 60000))), HasSubstr("longer than"));
  std::string bomb = "#define A0 L.z\n";
  for (int i = 1; i < 60; ++i)
    bomb += "#define A" + std::to_string(i) + " (A" + std::to_string(i - 1) + "+A" + std::to_string(i - 1) +
            ")\n";
  EXPECT_THAT(message(file(bomb + signature + " { return vec3(A59); }")), HasSubstr("macros expanded"));
  std::string nested = "#define T(x) (x+x)\n" + std::string(signature) + " { return vec3(";
  EXPECT_THAT(message(file(nested + repeated("T(", 40) + "L.z" + repeated(")", 40) + "); }")),
              HasSubstr("macros expanded"));
  std::string calls = "float f0(float x) { return x; }\n";
  for (int i = 1; i < 30; ++i)
    calls += "float f" + std::to_string(i) + "(float x) { return f" + std::to_string(i - 1) + "(x)+f" +
             std::to_string(i - 1) + "(x+1.0); }\n";
  EXPECT_THAT(message(file(calls + signature + " { return vec3(f29(L.z)); }")), HasSubstr("too large"));
  EXPECT_THAT(message(body("\nfloat t[100000]; return vec3(t[3]);")),
              AllOf(StartsWith("t.brdf:11:"), HasSubstr("'t' has 100000 numbers, more than the 4096")));
  EXPECT_THAT(message(file("struct S { vec3 a[1000]; mat4 b[100]; };\nS s[2];\n" + std::string(signature) +
                           " { return s[0].a[1]; }")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("'s' has 9200 numbers, more than the 4096")));
  EXPECT_THAT(message(body("return vec3(float(findMSB(int(9.0 * L.z))));")),
              AllOf(StartsWith("t.brdf:10:"), HasSubstr("findMSB is not supported")));
}

TEST(UserModel, ParametersBeyondWhatAMaterialHoldsAreRefused) {
  std::string many = "analytic\n::begin parameters\n";
  for (int i = 0; i < 500; ++i)
    many += "float p" + std::to_string(i) + " 0 1 0\n";
  EXPECT_THAT(
      message(many + "::end parameters\n::begin shader\n" + signature + " { return L; }\n::end shader\n"),
      AllOf(StartsWith("t.brdf:73:"), HasSubstr("500 numbers of parameters, more than the 70")));
}

// BRDF Explorer leaves out lines that begin so.
TEST(UserModel, LinesOfAHashAreCommentsUnlessTheyAreDirectives) {
  const std::string text = file("# defined once: don't \\\n#define TWO 2.0\n  #\n#definitely not\n" +
                                std::string(signature) + " {\n# here, \"too\nreturn vec3(TWO);\n  }");
  EXPECT_EQ(value(text, wo, wi)[0], 2);
  EXPECT_THAT(message(file("# one\n#if 1\n# two\nfloat f;\n#else\n#endif\n" + std::string(signature) +
                           " { return vec3(g); }")),
              StartsWith("t.brdf:15:"));
  EXPECT_THAT(message(file("\\\n#\n\\\n#foo\n")), StartsWith("t.brdf:1")); // no comment, no directive
  // A directive of several lines is one.
  EXPECT_EQ(value(file("#define SUM(x, y) \\\n  (x + \\\n   y)\n" + std::string(signature) +
                       " { return vec3(SUM(1.0, 2.0)); }"),
                  wo, wi)[0],
            3);
  EXPECT_THAT(message(file("#define SUM(x, y) \\\n  (x + \\\n   y)\n" + std::string(signature) +
                           " {\n return SUM(a, b); }")),
              AllOf(StartsWith("t.brdf:13:"), HasSubstr("undeclared")));
}

/// Files whose lanes part in branches and loops.
std::vector<std::string> varied() {
  std::vector<std::string> files{
      cloth(),
      body("float s = L.z; for (int i = 0; i < 20; ++i) { if (s < 0.05) break; s *= 0.8; if (L.x > 0.0) "
           "continue; "
           "s -= 0.01 * V.z; } return vec3(s, L.y > 0.0 ? s : 1.0 - s, float(int(9.0 * s)));"),
      body("float w[3] = float[3](0.5, 1.0, 2.0); return tone * w[int(2.9 * V.z)] * pow(L.z, a);"),
      body("return tone * (pow(a - 1.5, 2.0) + pow(L.x - a, 3.0) + pow(a - 2.0, 1.0) + pow(V.x * a, 7.0));")};
  for (const char* name : public_files)
    if (const std::string text = public_file(name); !text.empty()) files.push_back(text);
  return files;
}

Vec3d random_direction(int n, std::uint64_t which) {
  return spherical_direction(0.48 * pi * unit_double(hash(5, n, which)),
                             2 * pi * unit_double(hash(6, n, which)));
}

// The functions of packs are xsimd's: a few roundings from those of the standard library, times what a narrow
// lobe makes of them.
TEST(UserModel, EveryLaneOfAPackIsTheFloatValue) {
  for (const std::string& text : varied()) {
    const auto model = UserModel::parse(text, "t.brdf");
    const auto packs = initial<Pack>(*model);
    const auto floats = initial<float>(*model);
    for (int n = 0; n < 50; ++n) {
      std::array<std::array<float, pack_width>, 6> w;
      for (std::size_t l = 0; l < pack_width; ++l) {
        const Vec3d o = random_direction(n, 2 * l), i = random_direction(n, 2 * l + 1);
        w[0][l] = float(o.x), w[1][l] = float(o.y), w[2][l] = float(o.z);
        w[3][l] = float(i.x), w[4][l] = float(i.y), w[5][l] = float(i.z);
      }
      const auto at = [&](std::size_t k) { return load(w[k].data()); };
      const auto f = model->eval<Pack>(packs, {at(0), at(1), at(2)}, {at(3), at(4), at(5)});
      for (std::size_t l = 0; l < pack_width; ++l) {
        const auto one = model->eval<float>(floats, {w[0][l], w[1][l], w[2][l]}, {w[3][l], w[4][l], w[5][l]});
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(lane(f[c], l), one[c], 2e-4f * std::abs(one[c]) + 1e-6f) << text.substr(0, 200);
      }
    }
  }
}

TEST(UserModel, DerivativesAreThoseOfDifferences) {
  using D = Dual<double, 4>;
  for (const std::string& text : varied()) {
    const auto model = UserModel::parse(text, "t.brdf");
    std::vector<double> values = initial<double>(*model);
    // Away from the ends of the ranges, where clamps have kinks.
    std::vector<bool> is_switch;
    std::size_t place = 0;
    for (std::size_t p = 0; p < model->info().parameters.size(); ++p) {
      const ParameterInfo& info = model->info().parameters[p];
      for (int c = 0; c < (info.per_channel ? 3 : 1); ++c, ++place) {
        is_switch.push_back(model->is_switch(p));
        if (!is_switch.back()) values[place] = info.lo + (0.4 + 0.05 * c) * (info.hi - info.lo);
      }
    }
    for (int n = 0; n < 10; ++n) {
      const Vec3d o = random_direction(n, 100), i = random_direction(n, 101);
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (is_switch[k]) continue;
        std::vector<D> dual;
        for (const double x : values)
          dual.push_back(D(x));
        dual[k].d[2] = 1;
        const auto f = model->eval<D>(dual, vec3<D>(o), vec3<D>(i));
        const double h = 1e-5 * std::max(std::abs(values[k]), 1e-2);
        std::vector<double> below = values, above = values;
        below[k] -= h, above[k] += h;
        const auto f0 = model->eval<double>(below, o, i), f1 = model->eval<double>(above, o, i);
        for (int c = 0; c < 3; ++c) {
          const double slope = (f1[c] - f0[c]) / (2 * h);
          EXPECT_NEAR(f[c].d[2], slope, 1e-5 * std::abs(slope) + 1e-7 * (1 + std::abs(f[c].v)))
              << text.substr(0, 200) << " number " << k;
          EXPECT_EQ(f[c].d[0], 0);
        }
      }
    }
  }
}

TEST(UserModel, ThreadsDoNotMeet) {
  std::vector<std::shared_ptr<const UserModel>> models;
  for (int n = 0; n < 20; ++n) // more than a thread keeps machines
    models.push_back(UserModel::parse(body("float s = " + std::to_string(n) +
                                           ".0; for (int i = 0; i < 5; ++i) s += L.z; return vec3(s * a);"),
                                      "t.brdf"));
  std::vector<std::thread> threads;
  std::array<int, 4> wrong{};
  for (std::size_t t = 0; t < wrong.size(); ++t)
    threads.emplace_back([&, t] {
      for (int n = 0; n < 4000; ++n) {
        const double a = 0.1 * double((n + int(t)) % 20);
        const std::size_t m = hash(t, n) % models.size();
        const std::vector<double> values{a, 0, 0.2, 0.4, 0.6};
        const double f = models[m]->eval<double>(values, wo, wi)[0];
        wrong[t] += !(std::abs(f - a * (double(m) + 5 * wi.z)) < 1e-9);
      }
    });
  for (auto& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, (std::array<int, 4>{}));
}

// A failure leaves nothing behind in the machine that the thread keeps.
TEST(UserModel, RunsAgainAfterAFailure) {
  const auto model = UserModel::parse(body("float t[2] = float[2](1.0, 2.0); float s = 0.0; for (int i = 0; "
                                           "i < 3; ++i) s += t[int(a * float(i))]; "
                                           "return vec3(s);"),
                                      "t.brdf");
  const auto at = [&](double a) {
    return model->eval<double>(std::vector<double>{a, 0, 0, 0, 0}, wo, wi)[0];
  };
  EXPECT_EQ(at(0.5), 4);
  EXPECT_THROW(at(2), Error);
  EXPECT_EQ(at(0.5), 4);
}

} // namespace
} // namespace nacre

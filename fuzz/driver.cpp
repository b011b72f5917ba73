// Runs the fuzz target of every measured format on a fixed number of mutated inputs, the same ones each time.
//
//   nacre_fuzz [--inputs N] [--format=NAME]    N inputs a format, fewer of large files
//   nacre_fuzz --write-seeds FOLDER            the inputs that mutations start from, for libFuzzer's corpus
//
// Seeds are what a format's encoder makes of small measurements, and the files in fuzz/corpus/NAME.

#include "core/error.h"
#include "core/file.h"
#include "measured/material_as_measurement.h"
#include "measured_target.h"
#include "mutation.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <new>
#include <unistd.h>

namespace {

/// No input here is larger than some megabytes: whoever asks for this much believed a header.
constexpr std::size_t largest_allocation = std::size_t(1) << 28;

} // namespace

void* operator new(std::size_t n) {
  if (n <= largest_allocation)
    if (void* p = std::malloc(n > 0 ? n : 1)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace nacre {
namespace {

/// The input at work, for whoever has to report it.
const Bytes* current = nullptr;
std::string fault_file;

void on_fault(int signal) {
  constexpr char note[] = "nacre_fuzz: a signal (time over after 20 s, if it is 14); the input is in ";
  const auto put = [](const char* text, std::size_t n) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, n);
  };
  put(note, sizeof note - 1);
  put(fault_file.data(), fault_file.size());
  put("\n", 1);
  std::signal(signal, SIG_DFL);
  if (std::FILE* file = std::fopen(fault_file.c_str(), "wb")) {
    std::fwrite(current->data(), 1, current->size(), file);
    std::fclose(file);
  }
  std::_Exit(128 + signal);
}

std::vector<Bytes> seeds_of(const MeasuredFormat& format) {
  std::vector<Bytes> seeds;
  if (format.encode) {
    const MerlTable table =
        MerlTable::tabulate(6, 5, 8, [](double h, double, double) -> std::array<double, 3> {
          if (h > 1.2) return {-1, -1, -1};
          return {0.1 + std::exp(-h), 0.1, 0.02 + h};
        });
    const MaterialAsMeasurement metal(parse_material("ggx_conductor:alpha_x=0.3,alpha_y=0.5")),
        glass(parse_material("ggx_dielectric:alpha_x=0.4,alpha_y=0.4"));
    for (const MeasuredBsdf* measured :
         {static_cast<const MeasuredBsdf*>(&table), static_cast<const MeasuredBsdf*>(&metal),
          static_cast<const MeasuredBsdf*>(&glass)})
      try {
        seeds.push_back(format.encode(*measured));
      } catch (const Error&) { // not something that this format holds
      }
  }
  const std::filesystem::path folder =
      std::filesystem::path(NACRE_SOURCE_DIR) / "fuzz/corpus" / std::string(format.name);
  std::vector<std::string> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& file : std::filesystem::directory_iterator(folder))
      files.push_back(file.path().string());
  std::sort(files.begin(), files.end());
  for (const std::string& file : files)
    seeds.push_back(read_file(file));
  // A table of fixed size, two megabytes: all black.
  if (format.name == "utia") seeds.push_back(Bytes(std::size_t(6) * 48 * 6 * 48 * 3 * sizeof(double)));
  // Large seeds cost time and show nothing that small ones do not.
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Bytes& a, const Bytes& b) { return a.size() < b.size(); });
  constexpr std::size_t large = 1 << 20;
  while (seeds.size() > 1 && seeds.back().size() > large)
    seeds.pop_back();
  return seeds;
}

/// False if there was a fault.
bool run(const Bytes& input) {
  current = &input;
  ::alarm(20);
  try {
    LLVMFuzzerTestOneInput(input.data(), input.size());
    ::alarm(0);
    return true;
  } catch (const std::exception& e) {
    ::alarm(0);
    write_file_atomically(fault_file, input);
    std::cerr << "nacre_fuzz: " << e.what() << "; the input is in " << fault_file << "\n";
    return false;
  }
}

bool fuzz(const MeasuredFormat& format, std::size_t inputs) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  select_format(format);
  fault_file = fmt::format("fuzz-{}.bin", format.name);
  const std::vector<Bytes> seeds = seeds_of(format);
  if (seeds.empty()) {
    std::cerr << fmt::format("nacre_fuzz: {} has no seeds: put some into fuzz/corpus/{}\n", format.name,
                             format.name);
    return false;
  }
  std::size_t bytes = 0;
  for (const Bytes& seed : seeds) {
    bytes += seed.size();
    if (!run(seed)) return false;
  }
  if (fuzz_counts().refused > 0) {
    std::cerr << fmt::format("nacre_fuzz: {} refuses {} of its {} seeds\n", format.name,
                             fuzz_counts().refused, seeds.size());
    return false;
  }
  // So that all formats together take some seconds: a hundred megabytes each.
  const std::size_t affordable = std::max<std::size_t>(100, 100'000'000 / (bytes / seeds.size() + 1));
  std::mt19937 random(20240501);
  for (std::size_t i = 0; i < std::min(inputs, affordable); ++i)
    if (!run(mutated(seeds[i % seeds.size()], random))) return false;
  const FuzzCounts& counts = fuzz_counts();
  std::cout << fmt::format(
      "{:<20} {:>3} seeds of {:>8} bytes on average, {:>6} inputs: {} read, {} refused, {:.1f} s\n",
      format.name, seeds.size(), bytes / seeds.size(), counts.read + counts.refused, counts.read,
      counts.refused, std::chrono::duration<double>(Clock::now() - start).count());
  return counts.refused > 0; // else the mutations changed nothing
}

void write_seeds(const std::string& folder) {
  for (const MeasuredFormat& format : fuzzed_formats()) {
    if (!format.parse) continue;
    const auto sub = std::filesystem::path(folder) / std::string(format.name);
    std::filesystem::create_directories(sub);
    int n = 0;
    for (const Bytes& seed : seeds_of(format))
      write_file_atomically((sub / fmt::format("seed-{}", n++)).string(), seed);
  }
}

int drive(const std::vector<std::string>& words) {
  std::size_t inputs = 2000;
  std::string only;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--write-seeds" && i + 1 < words.size()) {
      write_seeds(words[i + 1]);
      return 0;
    }
    if (words[i] == "--inputs" && i + 1 < words.size())
      inputs = std::strtoul(words[++i].c_str(), nullptr, 10);
    else if (words[i].starts_with("--format="))
      only = words[i].substr(9);
    else
      throw Error("expected --inputs N, --format=NAME or --write-seeds FOLDER, found " + words[i]);
  }
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGALRM})
    std::signal(signal, on_fault);
  bool sound = true;
  for (const MeasuredFormat& format : fuzzed_formats())
    if (format.parse && (only.empty() || only == format.name)) sound = fuzz(format, inputs) && sound;
  return sound ? 0 : 1;
}

} // namespace
} // namespace nacre

int main(int argc, char** argv) {
  try {
    return nacre::drive({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << "nacre_fuzz: " << e.what() << "\n";
    return 2;
  }
}

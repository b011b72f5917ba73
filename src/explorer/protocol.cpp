#include "explorer/protocol.h"

#include "core/error.h"
#include "core/printable.h"

#include <bit>
#include <charconv>
#include <cstring>
#include <fmt/format.h>

namespace nacre {

static_assert(std::endian::native == std::endian::little, "arrays travel as they lie in memory");

namespace {

using nlohmann::json;

constexpr std::string_view source = "message";

std::size_t size_of(const std::vector<std::size_t>& shape) {
  std::size_t n = 1;
  for (const std::size_t s : shape)
    n *= s;
  return n;
}

/// The parser calls itself for each level of nesting: a deep message must not reach the end of the stack.
void check_nesting(std::string_view text) {
  constexpr int deepest = 64;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else
        in_string = c != '"';
      continue;
    }
    if (c == '"') in_string = true;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > deepest)
      throw Error::in_binary(source, i, fmt::format("nested more than {} levels deep", deepest));
  }
}

/// What a client sent comes back in a message as far as a person reads it: of long words the beginning and
/// the end, where a path has its file and its line, and so of the whole.
std::string readable(std::string_view text) {
  constexpr std::size_t longest_word = 160, longest = 2000;
  // Of "beginning ... end" each side has its share; bytes of a character stay together.
  const auto cut = [](std::string_view part, std::size_t begin, std::size_t end) {
    const auto continues = [&](std::size_t at) {
      return (static_cast<unsigned char>(part[at]) & 0xc0) == 0x80;
    };
    std::size_t to = begin, from = part.size() - end;
    while (to > begin - 4 && continues(to))
      --to;
    while (from < part.size() && continues(from))
      ++from;
    return std::string(part.substr(0, to)) + "..." + std::string(part.substr(from));
  };
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    result += end > longest_word ? cut(text.substr(0, end), 80, 60) : std::string(text.substr(0, end));
    text.remove_prefix(end);
    if (text.empty()) break;
    result += text[0];
    text.remove_prefix(1);
    if (result.size() > 4 * longest) { // enough is kept for the beginning
      result += text.substr(text.size() - std::min(text.size(), longest));
      break;
    }
  }
  return printable(result.size() > longest ? cut(result, 1200, 700) : result);
}

/// Text of a header; invalid UTF-8, as file names may have it, is replaced.
std::string dump(const json& j) { return j.dump(-1, ' ', false, json::error_handler_t::replace); }

} // namespace

void Answer::add(std::string name, std::vector<std::size_t> shape, std::vector<float> data) {
  if (size_of(shape) != data.size()) throw std::logic_error("array '" + name + "' is not of its shape");
  arrays.push_back({std::move(name), std::move(shape), std::move(data)});
}

void Answer::add_image(std::string name, const Image& image) {
  const auto width = std::size_t(image.width), height = std::size_t(image.height);
  const auto channels = std::size_t(image.channel_count());
  std::vector<float> data(width * height * 3);
  for (std::size_t i = 0; i < width * height; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      data[3 * i + c] = image.data[i * channels + std::min(c, channels - 1)];
  add(std::move(name), {height, width, 3}, std::move(data));
}

Request decode_request(std::string_view text) {
  check_nesting(text);
  json body;
  try {
    body = json::parse(text);
  } catch (const json::parse_error& e) {
    throw Error::in_binary(source, e.byte, "not valid JSON");
  }
  if (!body.is_object()) throw Error("message: expected an object {\"id\": ..., \"type\": ...}");
  const auto id = body.find("id");
  if (id == body.end() || !id->is_number_integer() || *id < 0)
    throw Error("message: expected a whole number \"id\"");
  const auto type = body.find("type");
  if (type == body.end() || !type->is_string()) throw Error("message: expected a text \"type\"");
  Request request{id->get<std::int64_t>(), type->get<std::string>(), "", {}};
  if (const auto slot = body.find("slot"); slot != body.end()) {
    if (!slot->is_string()) throw Error("message: \"slot\" is a text");
    request.slot = slot->get<std::string>();
  }
  request.body = std::move(body);
  return request;
}

std::int64_t id_of_malformed(std::string_view text) noexcept {
  try {
    check_nesting(text);
    const json body = json::parse(text, nullptr, false);
    if (body.is_object() && body.contains("id") && body["id"].is_number_integer())
      return body["id"].get<std::int64_t>();
  } catch (...) {
  }
  return -1;
}

Message encode(std::int64_t id, const Answer& answer) {
  json header = answer.header;
  header["id"] = id;
  if (!header.contains("ok")) header["ok"] = true;
  if (answer.arrays.empty()) return {false, dump(header)};
  header["arrays"] = json::array();
  std::size_t numbers = 0;
  for (const NamedArray& a : answer.arrays) {
    header["arrays"].push_back({{"name", a.name}, {"shape", a.shape}});
    numbers += a.data.size();
  }
  const std::string text = dump(header);
  const std::size_t begin = (4 + text.size() + 3) / 4 * 4;
  Message message{true, std::string(begin + numbers * sizeof(float), '\0')};
  const auto length = std::uint32_t(text.size());
  std::memcpy(message.bytes.data(), &length, 4);
  std::memcpy(message.bytes.data() + 4, text.data(), text.size());
  char* to = message.bytes.data() + begin;
  for (const NamedArray& a : answer.arrays) {
    if (!a.data.empty()) std::memcpy(to, a.data.data(), a.data.size() * sizeof(float));
    to += a.data.size() * sizeof(float);
  }
  return message;
}

Message encode_error(std::int64_t id, std::string_view text) {
  json error{{"message", readable(text)}};
  // "FILE:LINE: " or "FILE:LINE:COLUMN: ", as Error::in_text writes it; the name may hold colons itself.
  const std::size_t end = text.find(": ");
  std::vector<int> places;
  std::string_view head = text.substr(0, end == std::string_view::npos ? 0 : end);
  while (places.size() < 2) {
    const std::size_t colon = head.rfind(':');
    int number = 0;
    if (colon == std::string_view::npos) break;
    const char *first = head.data() + colon + 1, *last = head.data() + head.size();
    if (const auto r = std::from_chars(first, last, number); r.ec != std::errc() || r.ptr != last) break;
    places.insert(places.begin(), number);
    head = head.substr(0, colon);
  }
  if (!places.empty()) error["line"] = places[0];
  if (places.size() == 2) error["column"] = places[1];
  json header{{"error", error}};
  if (id >= 0) header["id"] = id;
  return {false, dump(header)};
}

Message encode_cancelled(std::int64_t id) {
  return {false, dump({{"id", id}, {"ok", true}, {"cancelled", true}})};
}

DecodedAnswer decode_answer(const Message& message) {
  const std::string& bytes = message.bytes;
  if (!message.is_binary) return {json::parse(bytes), {}};
  std::uint32_t length = 0;
  if (bytes.size() < 4) throw Error::in_binary(source, 0, "expected four bytes of the header's length");
  std::memcpy(&length, bytes.data(), 4);
  if (length > bytes.size() - 4) throw Error::in_binary(source, 0, "the header is longer than the message");
  DecodedAnswer answer{json::parse(std::string_view(bytes).substr(4, length)), {}};
  std::size_t at = (4 + std::size_t(length) + 3) / 4 * 4;
  for (const json& entry : answer.header.at("arrays")) {
    NamedArray a{entry.at("name"), entry.at("shape").get<std::vector<std::size_t>>(), {}};
    const std::size_t n = size_of(a.shape);
    if (at > bytes.size() || n > (bytes.size() - at) / sizeof(float))
      throw Error::in_binary(source, at, "array '" + a.name + "' is longer than the message");
    a.data.resize(n);
    if (n > 0) std::memcpy(a.data.data(), bytes.data() + at, n * sizeof(float));
    at += n * sizeof(float);
    answer.arrays.push_back(std::move(a));
  }
  if (at != bytes.size()) throw Error::in_binary(source, at, "bytes after the last array");
  return answer;
}

} // namespace nacre

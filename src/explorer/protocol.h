#pragma once
// The explorer's messages as bytes, both ways: docs/explorer-protocol.md.

#include "explorer/message.h"

#include <stdexcept>
#include <string_view>

namespace nacre {

struct Request {
  std::int64_t id = -1;
  std::string type;
  std::string slot;    ///< of a kind marked latest; may be empty
  nlohmann::json body; ///< the whole message
};

/// @throws Error saying what is malformed: no JSON (with the byte), no object, no id, no type, nested too
/// deeply
Request decode_request(std::string_view text);
/// The id of a message that is no valid request, if it has one; else -1.
std::int64_t id_of_malformed(std::string_view text) noexcept;

/// Numbers that are not finite are null in the header and themselves in arrays.
Message encode(std::int64_t id, const Answer& answer);
/// The message that `error` is to a person; the line and column that a "FILE:LINE:COLUMN: " at its beginning
/// names are fields of their own.
Message encode_error(std::int64_t id, std::string_view error);
Message encode_cancelled(std::int64_t id);

struct DecodedAnswer {
  nlohmann::json header;
  std::vector<NamedArray> arrays;
};
/// What a page does with a message. @throws Error with the byte offset
DecodedAnswer decode_answer(const Message& message);

} // namespace nacre

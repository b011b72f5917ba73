#pragma once
// Whether the bytes of a file can be the OpenEXR image they claim to be, found out before any memory is
// allocated for it.

#include <cstdint>
#include <span>
#include <string>

namespace nacre {

/// Walks the header and the table of chunks of a single-part scanline or tiled file: every size must fit in
/// the file, the image must be of a size Nacre takes, every chunk of the full-resolution image must be there.
/// @throws Error with file name and byte offset
/// Source: openexr.com, Technical Introduction / OpenEXR File Layout.
void check_exr_plausible(std::span<const std::uint8_t> bytes, const std::string& path);

/// True for names of attributes that the file format itself gives a meaning and another type than free text.
bool is_reserved_exr_attribute(const std::string& name);

} // namespace nacre

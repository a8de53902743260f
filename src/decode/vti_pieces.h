// VTK's XML files that name others: image data in pieces (.pvti), and moments in time (.pvd).
#pragma once
#include "decode/output.h"

#include <filesystem>
#include <functional>
#include <pugixml.hpp>

namespace chiaro::decode {

/// Reads one of the files that are named.
using ReadNamed = std::function<Volume(const std::filesystem::path& file, Output& output)>;

/// The image that pieces make up: of `points` along each axis, with the geometry of `whole`.
/// Throws Error{input} where a piece is not what is said of it, and where voxels are in none. Memory: a piece more.
Volume read_pieces(const std::filesystem::path& path, const pugi::xml_node& image,
                   const std::array<std::int64_t, 3>& points, Volume whole, Output& output, const ReadNamed& read);

/// The wanted one of the moments.
Volume read_collection(const std::filesystem::path& path, const pugi::xml_node& collection, Output& output,
                       const ReadNamed& read);

}  // namespace chiaro::decode

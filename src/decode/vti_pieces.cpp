#include "decode/vti_pieces.h"

#include "decode/payload.h"
#include "decode/text.h"
#include "decode/vtk_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

namespace chiaro::decode {
namespace {

using Path = std::filesystem::path;
constexpr std::size_t max_files = 65536;

/// Of the whole's points, first and last along each axis.
using Extent = std::vector<std::int64_t>;

Extent extent_in(const Extent& whole, const pugi::xml_node& piece) {
    const Extent extent = integers(piece.attribute("Extent").as_string(), "Extent");
    if (extent.size() != 6) refuse(fmt::format("has a piece whose Extent has {} numbers, not 6", extent.size()));
    for (std::size_t a = 0; a < 6; a += 2)
        if (extent[a] < whole[a] || extent[a + 1] > whole[a + 1] || extent[a] > extent[a + 1])
            refuse("has a piece that lies outside of its whole extent");
    return extent;
}

/// Whether it has as many voxels as the extent has points, or cells.
bool fits(const Volume& piece, const Extent& extent, bool of_cells) {
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t between = extent[2 * a + 1] - extent[2 * a];
        if (piece.dimensions[a] != (of_cells ? std::max<std::int64_t>(between, 1) : between + 1)) return false;
    }
    return true;
}

/// Where pieces go.
class Whole {
public:
    Whole(Volume& volume, const Extent& extent)
        : volume_(volume), extent_(extent), is_there_(volume.voxel_count(), false) {}

    void put(const Volume& piece, const Extent& at) {
        const std::size_t voxel = size_of(volume_.type) * std::size_t(volume_.components);
        const std::size_t row = std::size_t(piece.dimensions[0]);
        const std::byte* from = piece.voxels.data();
        for (int z = 0; z < piece.dimensions[2]; ++z)
            for (int y = 0; y < piece.dimensions[1]; ++y, from += row * voxel) {
                const std::size_t first = index(at[0] - extent_[0], at[2] - extent_[2] + y, at[4] - extent_[4] + z);
                std::memcpy(volume_.voxels.data() + first * voxel, from, row * voxel);
                std::fill_n(is_there_.begin() + std::ptrdiff_t(first), row, true);
            }
    }
    std::size_t missing() const { return std::size_t(std::count(is_there_.begin(), is_there_.end(), false)); }

private:
    std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
        const auto [nx, ny, nz] = volume_.dimensions;
        return (std::size_t(z) * std::size_t(ny) + std::size_t(y)) * std::size_t(nx) + std::size_t(x);
    }

    Volume& volume_;
    const Extent& extent_;
    std::vector<bool> is_there_;
};

/// Before there is memory for it.
void check_pieces(const std::vector<Extent>& pieces, const std::array<std::int64_t, 3>& points) {
    double sum = 0;
    for (const Extent& e : pieces) sum += double(e[1] - e[0] + 1) * double(e[3] - e[2] + 1) * double(e[5] - e[4] + 1);
    if (sum < double(points[0]) * double(points[1]) * double(points[2]))
        refuse("has pieces that do not make up its whole extent");
}

}  // namespace

Volume read_pieces(const Path& path, const pugi::xml_node& image, const std::array<std::int64_t, 3>& points,
                   Volume whole, Output& output, const ReadNamed& read) {
    const Extent extent = integers(image.attribute("WholeExtent").as_string(), "WholeExtent");
    std::vector<Extent> extents;
    std::vector<Path> files;
    for (const auto& piece : image.children("Piece")) {
        if (files.size() == max_files) refuse(fmt::format("has more than {} pieces", max_files));
        extents.push_back(extent_in(extent, piece));
        files.push_back(confined(path, piece.attribute("Source").as_string()));
    }
    if (files.empty()) refuse("names no piece");
    check_pieces(extents, points);
    std::optional<Whole> put_together;
    bool of_cells = false;
    for (std::size_t i = 0; i < files.size(); ++i) {
        output.at(files[i].string());
        Output aside = output.aside();
        const Volume piece = read(files[i], aside);
        const auto lies = [&](const std::string& how) {
            refuse(fmt::format("names the piece '{}', which {}", files[i].filename().string(), how));
        };
        if (!put_together) {
            of_cells = !fits(piece, extents[i], false);
            set_shape({.name = "", .of_cells = of_cells, .type = piece.type, .components = piece.components}, points,
                      whole);
            whole.notes = piece.notes, whole.key_values = piece.key_values;
            output.allocate(whole);
            put_together.emplace(whole, extent);
        }
        if (!fits(piece, extents[i], of_cells)) lies("is of another size");
        if (piece.type != whole.type || piece.components != whole.components || piece.key_values != whole.key_values)
            lies("holds another kind of values than the first one");
        put_together->put(piece, extents[i]);
        output.progress(double(i + 1) / double(files.size()));
    }
    if (const std::size_t missing = put_together->missing(); missing > 0)
        refuse(fmt::format("has pieces that leave out {} of {} voxels", missing, whole.voxel_count()));
    return whole;
}

Volume read_collection(const Path& path, const pugi::xml_node& collection, Output& output, const ReadNamed& read) {
    std::map<double, std::string> files;
    for (const auto& entry : collection.children("DataSet")) {
        const std::string file = entry.attribute("file").as_string();
        const auto time = numbers(entry.attribute("timestep").as_string("0"), "timestep");
        if (time.size() != 1 || !std::isfinite(time[0])) refuse("has a data set whose timestep is not one number");
        if (!files.emplace(time[0], file).second)
            refuse(fmt::format("has several data sets at the time {}: name one of their files", time[0]));
        if (files.size() > max_files) refuse(fmt::format("has more than {} moments", max_files));
    }
    if (files.empty()) refuse("names no data set");
    Volume header;
    const std::uint64_t wanted = output.choose_moment(files.size(), header);
    const auto& [time, file] = *std::next(files.begin(), std::ptrdiff_t(wanted));
    const Path named = confined(path, file);
    output.at(named.string());
    Volume volume = read(named, output);
    volume.moments = header.moments;
    for (const auto& [each, its] : files) volume.moments.times.push_back(each);
    return volume;
}

}  // namespace chiaro::decode

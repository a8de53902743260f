#include "hostile/chunked_seeds.h"

#include "hdf5_files.h"
#include "vdb_bytes.h"
#include "zarr_files.h"

namespace hostile {

using namespace chiaro;
using namespace volume_files;

void add_hdf5(std::vector<Seed>& all) {
    const Folder folder;
    const hid_t plain = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(plain, false);  // or the bytes would never be the same
    const hid_t packed = H5Pcopy(plain);
    const hsize_t chunk[] = {1, 2, 4};
    H5Pset_chunk(packed, 3, chunk), H5Pset_shuffle(packed), H5Pset_deflate(packed, 6), H5Pset_fletcher32(packed);
    Hdf5(folder / "plain.h5").dataset("density", {2, 3, 4}, ramp<std::uint16_t>(24), plain);
    Hdf5(folder / "packed.h5").dataset("density", {2, 3, 4}, ramp<float>(24), packed);
    Hdf5(folder / "named.h5").dataset("t", {2, 3, 4}, ramp<float>(24), plain).text("axistags", axistags("tyx"));
    H5Pclose(plain), H5Pclose(packed);
    for (const char* name : {"plain.h5", "packed.h5", "named.h5"})
        all.push_back({.name = name, .bytes = content_of(folder / name)});
}

void add_zarr(std::vector<Seed>& all) {
    ZarrLayout layout{.shape = {1, 2, 3, 4}, .chunk = {1, 2, 3, 3}, .codec = "zlib"};
    const auto add = [&](const auto& files) {
        for (const auto& [name, bytes] : files) {
            Seed seed{.name = name, .bytes = bytes, .opened = ".", .is_text = name.ends_with("json") || name[0] == '.'};
            for (const auto& other : files)
                if (other.first != name) seed.beside.push_back(other);
            all.push_back(seed);
        }
    };
    add(zarr_files(layout, ramp<std::uint16_t>(24)));
    layout = {.shape = {2, 3, 4}, .chunk = {2, 3, 3}, .version = 3, .codec = "gzip", .has_checksum = true};
    layout.shard = {2, 3, 6};
    add(zarr_files(layout, ramp<float>(24)));
}

bool reads_vdb() { return fs::exists(built("chiaro-decode-vdb")); }

void add_vdb(std::vector<Seed>& all) {
    if (!reads_vdb()) return;
    all.push_back({.name = "packed.vdb", .bytes = VdbBytes().bytes()});
    all.push_back({.name = "plain.vdb", .bytes = VdbBytes{.is_packed = false}.bytes()});
    all.push_back({.name = "old.vdb", .bytes = VdbBytes{.version = 221}.bytes()});
}

}  // namespace hostile

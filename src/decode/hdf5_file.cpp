#include "decode/hdf5_file.h"

#include "decode/byte_source.h"
#include "decode/limits.h"
#include "decode/output.h"

#include <fmt/format.h>

#include <cstdlib>

namespace chiaro::decode {
namespace {

herr_t take_dataset(hid_t, const char* name, const H5O_info_t* info, void* to) {
    auto& names = *static_cast<std::vector<std::string>*>(to);
    if (info->type == H5O_TYPE_DATASET) names.push_back("/" + std::string(name));
    constexpr std::size_t enough = 10'000;
    return names.size() >= enough;
}

/// Each step of the path must exist in this file.
void check_links(hid_t file, const std::string& path) {
    for (auto end = path.find('/', 1);; end = path.find('/', end + 1)) {
        const std::string step = path.substr(0, end);
        if (step.size() > 1) {
            H5L_info_t info{};
            if (H5Lget_info(file, step.c_str(), &info, H5P_DEFAULT) < 0) refuse(fmt::format("holds no '{}'", step));
            if (info.type != H5L_TYPE_HARD && info.type != H5L_TYPE_SOFT)
                refuse(fmt::format("has at '{}' a link into another file, which is not followed", step));
        }
        if (end == std::string::npos) return;
    }
}

void check_storage(hid_t dataset, const std::string& path) {
    const Hdf5Id made(H5Dget_create_plist(dataset), H5Pclose);
    if (!made.is_valid()) refuse(fmt::format("has a dataset '{}' that cannot be opened", path));
    if (H5Pget_layout(made) == H5D_VIRTUAL)
        refuse(fmt::format("has in '{}' a virtual dataset, put together from others, which is not read", path));
    if (H5Pget_external_count(made) != 0)
        refuse(fmt::format("has the values of '{}' in other files, which are not opened", path));
    for (int i = 0; i < H5Pget_nfilters(made); ++i) {
        unsigned flags = 0;
        std::size_t values = 0;
        char name[64] = "";
        const auto filter = H5Pget_filter2(made, unsigned(i), &flags, &values, nullptr, sizeof name, name, nullptr);
        if (filter < 0 || H5Zfilter_avail(filter) <= 0)
            refuse(
                fmt::format("has '{}' compressed by the filter '{}' ({}), which is not read", path, name, int(filter)));
    }
}

}  // namespace

Hdf5Id open_hdf5(const std::filesystem::path& path) {
    // Chunks are allocated as large as is stated. None grows more than this when it is inflated, and filters hold
    // three.
    limit_own_memory((std::uint64_t(32) << 20) + 3 * largest_deflate_ratio * regular_file_size(path));
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);  // a folder without write access is no reason to refuse
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    H5Lunregister(H5L_TYPE_EXTERNAL);
    Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file.is_valid()) refuse("is no HDF5 file, or a damaged or truncated one");
    return file;
}

std::vector<std::string> datasets_in(hid_t file) {
    std::vector<std::string> names;
    if (H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, take_dataset, &names) < 0)
        refuse("has a tree of groups that is damaged");
    return names;
}

Hdf5Id open_dataset(hid_t file, const std::string& path) {
    check_links(file, path);
    Hdf5Id dataset(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose);
    if (!dataset.is_valid()) refuse(fmt::format("has '{}' that cannot be opened", path));
    if (H5Iget_type(dataset) != H5I_DATASET) refuse(fmt::format("has at '{}' no dataset but a group or a type", path));
    check_storage(dataset, path);
    return dataset;
}

std::string text_attribute(hid_t object, const char* name) {
    if (H5Aexists(object, name) <= 0) return {};
    const Hdf5Id stored(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Id type(H5Aget_type(stored), H5Tclose);
    constexpr std::size_t longest = 4096;
    if (H5Tget_class(type) != H5T_STRING || H5Tget_size(type) > longest) return {};
    if (H5Tis_variable_str(type) > 0) {
        char* read = nullptr;
        if (H5Aread(stored, type, &read) < 0 || !read) return {};
        const std::string text(read);
        H5free_memory(read);
        return text;
    }
    std::string text(H5Tget_size(type) + 1, '\0');
    if (H5Aread(stored, type, text.data()) < 0) return {};
    text.resize(text.find('\0'));
    return text;
}

}  // namespace chiaro::decode

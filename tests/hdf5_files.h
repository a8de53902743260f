// Small HDF5 files, written by its library.
#pragma once
#include "volume_files.h"

#include <fmt/format.h>
#include <hdf5.h>

namespace volume_files {

template <class T>
hid_t hdf5_type() {
    if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_integral_v<T>) {
        const hid_t types[2][4] = {{H5T_NATIVE_UINT8, H5T_NATIVE_UINT16, H5T_NATIVE_UINT32, H5T_NATIVE_UINT64},
                                   {H5T_NATIVE_INT8, H5T_NATIVE_INT16, H5T_NATIVE_INT32, H5T_NATIVE_INT64}};
        return types[std::is_signed_v<T>][sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 1 : sizeof(T) == 4 ? 2 : 3];
    }
}

/// A file being written; identifiers are closed with it.
class Hdf5 {
public:
    explicit Hdf5(const fs::path& path) : path_(path.string()) {
        const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
        file_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
        H5Pclose(access);
        links_ = H5Pcreate(H5P_LINK_CREATE);
        H5Pset_create_intermediate_group(links_, 1);
    }
    Hdf5(const Hdf5&) = delete;
    Hdf5& operator=(const Hdf5&) = delete;
    ~Hdf5() {
        H5Pclose(links_);
        H5Fclose(file_);
    }
    hid_t file() const { return file_; }
    const std::string& path() const { return path_; }

    /// Sizes are slowest first. `made` (creation properties) and `stored` (type in the file) as the library takes them.
    template <class T>
    Hdf5& dataset(const std::string& name, const std::vector<hsize_t>& sizes, const std::vector<T>& values,
                  hid_t made = H5P_DEFAULT, hid_t stored = -1) {
        const hid_t space = H5Screate_simple(int(sizes.size()), sizes.data(), nullptr);
        last_ = H5Dcreate2(file_, name.c_str(), stored < 0 ? hdf5_type<T>() : stored, space, links_, made, H5P_DEFAULT);
        EXPECT_GE(last_, 0);
        if (!values.empty()) H5Dwrite(last_, hdf5_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Sclose(space);
        return *this;
    }
    /// Of the dataset last written.
    Hdf5& attribute(const char* name, const std::vector<double>& values) {
        const hsize_t size = values.size();
        const hid_t space = H5Screate_simple(1, &size, nullptr);
        const hid_t id = H5Acreate2(last_, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(id, H5T_NATIVE_DOUBLE, values.data());
        return *this;
    }

    Hdf5& text(const char* name, const std::string& text) {
        const hid_t space = H5Screate(H5S_SCALAR), type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);  // as h5py writes them
        const hid_t id = H5Acreate2(last_, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        const char* const value = text.c_str();
        H5Awrite(id, type, &value);
        return *this;
    }

private:
    std::string path_;
    hid_t file_ = -1, links_ = -1, last_ = -1;
};

/// As vigra writes them.
inline std::string axistags(const std::string& letters) {
    std::string axes;
    for (const char letter : letters)
        axes += fmt::format(R"({}{{"key": "{}", "typeFlags": 2, "resolution": 0, "description": ""}})",
                            axes.empty() ? "" : ", ", letter);
    return R"({"axes": [)" + axes + "]}";
}

/// A valid file, as bytes: 4 x 3 x 2 voxels, contiguous, or in chunks that are shuffled and deflated.
inline std::string hdf5_file(const Folder& folder, bool chunked) {
    const hid_t made = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {1, 2, 4};
    if (chunked) {
        H5Pset_chunk(made, 3, chunk);
        H5Pset_shuffle(made);
        H5Pset_deflate(made, 6);
    }
    Hdf5(folder / "made.h5").dataset("density", {2, 3, 4}, ramp<std::uint16_t>(24), made);
    H5Pclose(made);
    return content_of(folder / "made.h5");
}

}  // namespace volume_files

// An HDF5 file that cannot lead out of itself, and its identifiers, closed in time.
#pragma once
#define H5_USE_110_API  // newer libraries have it too
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace chiaro::decode {

/// Owns an identifier of the library; negative where a call failed.
class Hdf5Id {
public:
    using Close = herr_t (*)(hid_t);
    Hdf5Id(hid_t id, Close close) : id_(id), close_(close) {}
    Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Hdf5Id& operator=(Hdf5Id&&) = delete;
    ~Hdf5Id() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }
    bool is_valid() const { return id_ >= 0; }

private:
    hid_t id_;
    Close close_;
};

/// Opens for reading; links into other files are not followed, and no filters are loaded from elsewhere.
/// Throws Error{input} for what is no HDF5, or is truncated.
Hdf5Id open_hdf5(const std::filesystem::path& path);

/// Paths of all datasets, each once, in the order of their names.
std::vector<std::string> datasets_in(hid_t file);

/// Text of an attribute; empty where there is none.
std::string text_attribute(hid_t object, const char* name);

/// Throws Error{input} unless there is a dataset at the path whose values lie in this file.
Hdf5Id open_dataset(hid_t file, const std::string& path);

}  // namespace chiaro::decode

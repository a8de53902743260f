// One small valid file of every kind that Chiaro reads: what hostile files are made from.
#pragma once
#include <chiaro/medium.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hostile {

/// Which part of the program reads it.
enum class Kind { volume, raw_name, probe, scene, transfer, emission, cache };

struct Seed {
    std::string name;         ///< of the file
    std::string format = {};  ///< "nrrd", "scene", ...: seeds() names it
    Kind kind = Kind::volume;
    std::string bytes;  ///< for Kind::raw_name the name; the file holds 24 bytes
    std::vector<std::pair<std::string, std::string>> beside = {};  ///< other files in its folder: name, bytes
    std::string opened = {};  ///< what is opened instead of the file: a header, or "." for the folder
    /// Makes checksums right again, so that a change reaches what lies behind them.
    std::function<std::string(std::string)> repair = {};
    /// What is done to the changed bytes before they are written: compression.
    std::function<std::string(std::string)> packed = {};
    bool is_text = false;        ///< numbers in it may be replaced
    bool is_open_ended = false;  ///< a beginning is a whole file too: no reader can tell that it was cut
    bool needs_end = false;      ///< a cut one is refused or told even where nothing that is asked for is lost
};

const std::vector<Seed>& seeds();

/// Whether this build has a decoder of OpenVDB's files; without one there are no seeds of it.
bool reads_vdb();

/// The volume that the seed of Kind::cache belongs to.
const chiaro::DeviceVolume& cached_volume();

}  // namespace hostile

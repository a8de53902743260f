// Headers that say something else: extremes, contradictions, fields given twice, left out or exchanged.
#pragma once
#include "hostile/mutations.h"

namespace hostile {

/// A number in a header of bytes.
struct BinaryField {
    std::size_t at, size;
    bool is_real = false, is_big_endian = false;
};

/// Where the seed's format has numbers as bytes: the fields of NIfTI, tags and links of TIFF, lengths of DICOM, sizes
/// and addresses of HDF5, checksummed lengths of PNG, parts of OpenVDB; of others the words at the start.
std::vector<BinaryField> binary_fields(const Seed& seed);

/// A field of a text header: all of it, and its value.
struct TextField {
    std::size_t begin, end, value_begin, value_end;
    bool is_single;  ///< its format has it once at most
};

/// Lines of NRRD, MetaImage, VTK, Radiance and lists; attributes of XML; members of JSON; elements of
/// DICOM whose value is text. None: the header is bytes.
std::vector<TextField> text_fields(const Seed& seed);

/// One edit; the same for the same state of `random`.
Mutant edited_header(const Seed& seed, std::mt19937_64& random);

/// Every known pair of statements of this seed that cannot both be true.
std::vector<Mutant> contradictions(const Seed& seed);

}  // namespace hostile

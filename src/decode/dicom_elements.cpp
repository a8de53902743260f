#include "decode/dicom_elements.h"

#include "decode/byte_source.h"
#include "decode/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

namespace chiaro::decode {
namespace {

constexpr std::uint32_t item = 0xfffee000, end_of_item = 0xfffee00d, end_of_sequence = 0xfffee0dd;
constexpr std::uint32_t until_a_delimiter = 0xffffffff;  ///< as a length

/// How the headers of a data set are written (PS3.5, 7.1).
struct Coding {
    bool is_explicit = true;  ///< with two letters for the type of the value
    bool big_endian = false;
};

struct Element {
    std::uint32_t tag = 0, length = 0;
    std::string_view type;
};

/// Goes from header to header, through sequences without a stated length, to the end or to what it cannot understand.
class Walk {
public:
    explicit Walk(const std::filesystem::path& path)
        : size_(regular_file_size(path)), file_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
    ~Walk() { close(file_); }
    Walk(const Walk&) = delete;
    Walk& operator=(const Walk&) = delete;

    void run() {
        at_ = text(128, 4) == "DICM" ? 132 : 0;
        Coding coding;
        while (is_known_ && number<2>(at_, {}) == 2) {  // the file's meta information
            const Element element = header({});
            if (element.tag == 0x00020010) coding.big_endian = text(at_, 19) == "1.2.840.10008.1.2.2";
            step(element);
        }
        if (!is_known_) return;
        const std::string_view letters = text(at_ + 4, 2);
        coding.is_explicit = letters.size() == 2 && is_letter(letters[0]) && is_letter(letters[1]);
        data_set(coding, 0);
    }

private:
    static bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }

    void data_set(Coding coding, int depth) {
        std::set<std::uint32_t> seen;
        while (is_known_ && at_ < size_) {
            const Element element = header(coding);
            if (element.tag == end_of_item) return;
            if (element.tag >> 16 == 0 || element.tag >> 16 >= 0xfffe) is_known_ = false;  // such as zeros at the end
            if (!is_known_) return;
            if (!seen.insert(element.tag).second)
                refuse(
                    fmt::format("states the element ({:04x},{:04x}) twice", element.tag >> 16, element.tag & 0xffff));
            if (element.length != until_a_delimiter)
                step(element);
            else if (depth < 32)
                sequence({coding.is_explicit && element.type != "UN", coding.big_endian}, depth + 1);
            else
                is_known_ = false;
        }
    }

    /// Items up to the delimiter: data sets, or fragments of pixels.
    void sequence(Coding coding, int depth) {
        while (is_known_ && at_ < size_) {
            const Element element = header({false, coding.big_endian});
            if (element.tag == end_of_sequence) return;
            if (element.tag != item)
                is_known_ = false;
            else if (element.length == until_a_delimiter)
                data_set(coding, depth);
            else if (element.length > size_ - at_)
                refuse(fmt::format("is truncated: it states an item of {} bytes where {} follow", element.length,
                                   size_ - at_));
            else
                at_ += element.length;
        }
    }

    void step(const Element& element) {
        is_known_ = is_known_ && element.length <= size_ - at_;
        if (is_known_) at_ += element.length;
    }

    Element header(Coding coding) {
        Element element;
        element.tag = number<2>(at_, coding) << 16 | number<2>(at_ + 2, coding);
        std::uint64_t taken = 8;
        if (!coding.is_explicit || element.tag >> 16 == 0xfffe) {
            element.length = number<4>(at_ + 4, coding);
        } else {
            constexpr std::array<std::string_view, 13> long_types{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                                  "SV", "UC", "UN", "UR", "UT", "UV"};
            const std::string_view type = text(at_ + 4, 2);
            is_known_ = is_known_ && is_letter(type[0]) && is_letter(type[1]);
            const auto* known = std::find(long_types.begin(), long_types.end(), type);
            const bool is_long = known != long_types.end();
            if (is_long) element.type = *known;
            element.length = is_long ? number<4>(at_ + 8, coding) : number<2>(at_ + 6, coding);
            taken = is_long ? 12 : 8;
        }
        at_ += taken;
        is_known_ = is_known_ && at_ <= size_;
        return element;
    }

    template <int bytes>
    std::uint32_t number(std::uint64_t at, Coding coding) {
        const std::string_view stored = text(at, bytes);
        std::uint32_t value = 0;
        for (int i = 0; i < int(stored.size()); ++i)
            value |= std::uint32_t(static_cast<unsigned char>(stored[std::size_t(i)]))
                     << 8 * (coding.big_endian ? bytes - 1 - i : i);
        return value;
    }

    /// So many bytes; none, and nothing more is understood, where the file has less. Valid until the next call.
    std::string_view text(std::uint64_t at, std::size_t bytes) {
        if (at < window_at_ || at + bytes > window_at_ + window_bytes_) {
            const ssize_t got = pread(file_, window_.data(), window_.size(), off_t(at));
            window_at_ = at;
            window_bytes_ = std::size_t(std::max<ssize_t>(0, got));
        }
        is_known_ = is_known_ && bytes <= window_at_ + window_bytes_ - at;
        return is_known_ ? std::string_view(window_.data() + (at - window_at_), bytes) : std::string_view();
    }

    std::uint64_t size_ = 0, at_ = 0, window_at_ = 0;
    std::size_t window_bytes_ = 0;
    std::array<char, 65536> window_{};
    int file_ = -1;
    bool is_known_ = true;  ///< whether all headers so far could be understood
};

}  // namespace

void check_dicom_elements(const std::filesystem::path& path) { Walk(path).run(); }

}  // namespace chiaro::decode

// Settings told once: every settings struct has `describe(visit, settings)` in <chiaro/describe.h>, which hands each
// setting to the visitor with its name, unit, range and one line of description. Flags, --help, JSON, validation and
// the documentation's tables come from it.
#pragma once
#include <limits>
#include <string_view>

namespace chiaro {

/// How a scene file keeps a value, where that is not simply the flag's text or its numbers.
enum class SceneForm {
    same,
    reciprocal,  ///< 1 / value
    on_off,      ///< true and false stand for phong and none
    list,        ///< a list of what the flag takes, which may be given again and again
    surfaces,    ///< a list of {value, color, opacity}, likewise
    lights,      ///< one as its flag's text or numbers, several as a list of these
    custom       ///< read and written by hand
};

/// What there is to know about one setting beside its value; the default is the initial value of its field.
struct Setting {
    std::string_view name;      ///< the flag without dashes; "no-..." switches its field off; "": scene files only
    std::string_view key;       ///< where it lives in a scene file, "sampling.early_termination"
    std::string_view unit;      ///< "" when it has none
    std::string_view sentence;  ///< what it does, in one line
    double lowest = -std::numeric_limits<double>::infinity();  ///< for each number in the value
    double highest = std::numeric_limits<double>::infinity();
    bool lowest_excluded = false;  ///< the range is open at `lowest`
    std::string_view form = "";    ///< how the value is written, "CENTER,WIDTH"; "a|b" for a bool: off|on
    SceneForm scene_form = SceneForm::same;
    std::string_view methods = "";  ///< the lighting methods that it belongs to, "a|b"; "": to every picture

    constexpr bool repeats() const {
        return scene_form == SceneForm::list || scene_form == SceneForm::surfaces || scene_form == SceneForm::lights;
    }

    constexpr Setting within(double low, double high) const {
        Setting s = *this;
        s.lowest = low, s.highest = high;
        return s;
    }
    constexpr Setting above(double low, double high = std::numeric_limits<double>::infinity()) const {
        Setting s = within(low, high);
        s.lowest_excluded = true;
        return s;
    }
    constexpr Setting written(std::string_view how) const {
        Setting s = *this;
        s.form = how;
        return s;
    }
    constexpr Setting of(std::string_view lighting_methods) const {
        Setting s = *this;
        s.methods = lighting_methods;
        return s;
    }
    /// Whether it matters to pictures by this lighting method.
    constexpr bool concerns(std::string_view lighting_method) const {
        return methods.empty() || belongs_to(lighting_method);
    }
    /// Whether it is this lighting method's own.
    constexpr bool belongs_to(std::string_view lighting_method) const {
        std::string_view rest = methods;
        while (!rest.empty()) {
            const std::size_t end = rest.find('|');
            if (rest.substr(0, end) == lighting_method) return true;
            rest = end == rest.npos ? "" : rest.substr(end + 1);
        }
        return false;
    }
    constexpr Setting kept(SceneForm how) const {
        Setting s = *this;
        s.scene_form = how;
        return s;
    }
};

}  // namespace chiaro

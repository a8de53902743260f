// The numbers that reflection.h looks up.
#pragma once
#include <vector>

#include "pathtrace/reflection.h"

namespace chiaro {

class ReflectionTable {
public:
    /// What `--specular` and `--shininess` say; a highlight that would reflect more than all is held at `most`.
    ReflectionTable(double strength, double shininess);

    kernel::ReflectionView view() const {
        return {float(strength_), float(shininess_), reflected_.data(), float(matte_)};
    }
    const std::vector<float>& numbers() const { return reflected_; }

private:
    static constexpr double most = 0.98;
    double strength_ = 0, shininess_, matte_ = 1;
    std::vector<float> reflected_;
};

}  // namespace chiaro

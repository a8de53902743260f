// What one highlight reflects of light from all around, and what it leaves to the matter (docs/theory/light.md).
#pragma once
#include <vector>

namespace chiaro {

class ReflectionTable {
public:
    /// What `--specular` and `--shininess` say; a highlight that would reflect more than all is held at `most`.
    ReflectionTable(double strength, double shininess);

    double strength() const { return strength_; }    ///< k, as it is held
    double shininess() const { return shininess_; }  ///< s
    double matte() const { return matte_; }          ///< 1 / (1 - ρ̄)
    /// ρ at μ = 0, 1/steps ... 1.
    const std::vector<float>& reflected() const { return reflected_; }
    static constexpr int steps = 32;

private:
    static constexpr double most = 0.98;
    double strength_ = 0, shininess_, matte_ = 1;
    std::vector<float> reflected_;
};

}  // namespace chiaro

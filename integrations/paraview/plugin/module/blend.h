// Frames of the processes of ParaView's server, blended as floats by IceT.
#pragma once
#include <chiaro/image.h>

#include <vector>

#include "vtkNew.h"

class vtkIceTContext;

namespace chiaro::from_paraview {

class FloatBlend {
public:
    FloatBlend();
    ~FloatBlend();
    /// Collective: the premultiplied frames of all processes, one over the other in the order of these numbers from the
    /// front to the back; what the first process' frame becomes. Throws Error{internal} on all where IceT cannot.
    void operator()(Frame& frame, const std::vector<int>& order);

private:
    vtkNew<vtkIceTContext> context_;
};

}  // namespace chiaro::from_paraview

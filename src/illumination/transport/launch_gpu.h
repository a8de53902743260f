// The kernels of transport as a GPU has them, compiled by launch_gpu.cu.
#pragma once
#include "cuda/run.h"
#include "illumination/transport/boundary_kernel.h"
#include "illumination/transport/colour_kernel.h"
#include "illumination/transport/downsample_by_3_kernel.h"
#include "illumination/transport/gpu_kernel.h"
#include "illumination/transport/light_kernel.h"
#include "illumination/transport/opaque_kernel.h"

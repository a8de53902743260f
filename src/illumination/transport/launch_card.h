// The kernels of transport as a card has them, compiled by launch_card.cu.
#pragma once
#include "cuda/run.h"
#include "illumination/transport/card_kernel.h"
#include "illumination/transport/colour_kernel.h"
#include "illumination/transport/light_kernel.h"
#include "illumination/transport/opaque_kernel.h"
#include "illumination/transport/skin_kernel.h"
#include "illumination/transport/third_kernel.h"

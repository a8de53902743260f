// All of Chiaro's public interface.
#pragma once
#include <chiaro/camera.h>
#include <chiaro/device.h>
#include <chiaro/error.h>
#include <chiaro/geometry.h>
#include <chiaro/image.h>
#include <chiaro/io.h>
#include <chiaro/lighting.h>
#include <chiaro/medium.h>
#include <chiaro/progress.h>
#include <chiaro/render.h>
#include <chiaro/samples.h>
#include <chiaro/scene.h>
#include <chiaro/session.h>
#include <chiaro/settings.h>
#include <chiaro/transfer_function.h>
#include <chiaro/volume.h>

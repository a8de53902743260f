// What the program does with a volume that was read.
#pragma once
#include <chiaro/volume.h>

namespace hostile {

/// Measures it and renders a small picture on one thread. Throws what the program would, and Error{internal} where
/// the range of finite values is not finite.
void show(chiaro::Volume&& volume);

}  // namespace hostile

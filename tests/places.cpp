// The one unit that knows paths: all others are the same in every clone, so a compiler cache has them.
#include "places.h"

std::string built(const std::string& program) { return CHIARO_BIN "/" + program; }
std::string of_project(const std::string& file) { return CHIARO_SOURCE "/" + file; }

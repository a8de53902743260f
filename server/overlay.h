// What a page draws over a picture that it saves: a scale bar, a legend. The page has the fonts.
#pragma once
#include <chiaro/image.h>

#include <vector>

#include "json.h"

namespace chiaro::server {

struct Overlay {
    int x, y;  ///< of its left upper pixel in the picture
    Image image;
};

/// Of a request's member "overlays", [{"at": [x, y], "png": base64}], none where it is missing. Throws Error{usage} for
/// more than four, and for one that is no PNG or does not lie within the picture.
std::vector<Overlay> overlays_in(const Json& request, int width, int height);

/// By its alpha over display colours as they are.
void draw(const Overlay& overlay, Image& image);
/// By its alpha over linear light, in which its colours are display white at most.
void draw(const Overlay& overlay, Frame& frame);

}  // namespace chiaro::server

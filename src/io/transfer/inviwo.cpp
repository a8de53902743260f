// Inviwo's .itf: XML in two generations, <InviwoTreeData> with <dataPoints> and <InviwoWorkspace> with <Points>.
// A point has a position, a share of the data's range unless <type> is 1, and straight sRGB with alpha. Inviwo's alpha
// belongs to 1/150 of the volume's edge; as it depends on the volume, it is left to --opacity-unit.
#include <limits>

#include "io/transfer/curve.h"
#include "io/transfer/xml_node.h"

namespace chiaro {
namespace {

bool is_relative(const XmlNode& root) {
    const pugi::xml_node type = root.node.child("type");
    if (!type) return true;
    const double value = XmlNode{type, root.text}.number("content");
    if (value != 0 && value != 1)
        XmlNode{type, root.text}.fail(fmt::format("content is {}: must be 0 (relative) or 1 (absolute)", value));
    return value == 0;
}

ControlPoint read_point(const XmlNode& node, bool relative) {
    const XmlNode place = node.child("pos"), rgba = node.child("rgba");
    const char* attribute = place.node.attribute("content") ? "content" : "x";  // the older also has y, the alpha again
    ControlPoint point;
    point.value = relative ? place.number_in(attribute, 0, 1) : place.position_at(attribute);
    point.rgb = {rgba.number_in("x", 0, 1), rgba.number_in("y", 0, 1), rgba.number_in("z", 0, 1)};
    point.opacity = rgba.number_in("w", 0, 1);
    return point;
}

std::vector<ControlPoint> read_points(const XmlNode& list, bool relative) {
    std::vector<ControlPoint> points;
    for (const pugi::xml_node child : list.node.children()) {
        if (child.type() != pugi::node_element) continue;
        const XmlNode node{child, list.text};
        const std::string name = child.name();
        if (name != "Point" && name != "point" && name != "TFPrimitive") node.fail("is no point of the function");
        if (points.size() == max_transfer_points) list.fail(fmt::format("has more than {} points", points.size()));
        points.push_back(read_point(node, relative));
    }
    if (points.empty()) list.fail("has no points: must have at least one");
    std::stable_sort(points.begin(), points.end(), [](auto& a, auto& b) { return a.value < b.value; });
    return points;
}

/// A mask that hides nothing has the ends of the range or, where values are absolute, of all numbers.
void apply_mask(const XmlNode& root, bool relative, std::vector<ControlPoint>& points) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double low = -infinity, high = infinity;
    if (const pugi::xml_node node = root.node.child("maskMin")) low = XmlNode{node, root.text}.number("content");
    if (const pugi::xml_node node = root.node.child("maskMax")) high = XmlNode{node, root.text}.number("content");
    if (!(low < high)) root.fail(fmt::format("has a mask from {} to {}: must rise", low, high));
    const double none = relative ? 0 : -1e300, all = relative ? 1 : 1e300;
    mask(points, low > none ? low : -infinity, high < all ? high : infinity);
}

}  // namespace

FoundFunction read_inviwo(const TransferText& text, const Statistics&) {
    XmlNode root = xml_root(text, {"InviwoWorkspace", "InviwoTreeData", "TransferFunction"});
    const auto list_in = [](const XmlNode& node) { return node.any_child({"Points", "dataPoints", "TFPrimitives"}); };
    if (!list_in(root))
        if (const pugi::xml_node inner = root.any_child({"TransferFunction", "transferFunction"})) root.node = inner;
    const pugi::xml_node list = list_in(root);
    if (!list) root.fail("lacks <Points>");
    FoundFunction found;
    found.relative = is_relative(root);
    auto& points = found.function.points;
    points = read_points({list, text}, found.relative);
    apply_mask(root, found.relative, points);
    if (found.relative) span_domain(points, 0, 1);
    if (const pugi::xml_node kind = root.any_child({"interpolationType_", "interpolationType"}))
        if (XmlNode{kind, text}.number("content") != 0)
            found.notes.push_back("its curves between points are taken as straight lines");
    if (found.relative) found.notes.push_back("its values are shares of a range, stretched over the data's");
    return found;
}

}  // namespace chiaro

// XML forbids an element to state an attribute twice; pugixml takes the first and says nothing.
#pragma once
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_set>

namespace chiaro {

/// An attribute that an element of the document states twice, "x of <point>"; empty where there is none.
inline std::string attribute_stated_twice(pugi::xml_document& document) {
    struct Walker : pugi::xml_tree_walker {
        std::string found;
        bool for_each(pugi::xml_node& node) override {
            std::unordered_set<std::string_view> names;
            for (const pugi::xml_attribute& attribute : node.attributes())
                if (!names.insert(attribute.name()).second)
                    found = std::string(attribute.name()) + " of <" + node.name() + ">";
            return found.empty();
        }
    } walker;
    document.traverse(walker);
    return walker.found;
}

}  // namespace chiaro

// Writes the plugin's server manager XML: the representation "Chiaro" with a property for each setting of a look that
// is not the data's, the camera's or the volume property's.
#include <chiaro/describe.h>

#include <cctype>
#include <cmath>
#include <cstdio>
#include <set>

using namespace chiaro;

namespace {

const std::set<std::string_view> groups{"Sampling",
                                        "Light probe",
                                        "Floor",
                                        "Lighting",
                                        "Lighting by spao",
                                        "Lighting by visibility",
                                        "Lighting by histogram",
                                        "Lighting by transport",
                                        "Lighting by reference",
                                        "Scattering",
                                        "Output"};
/// What ParaView's own settings say, or what has no place there.
const std::set<std::string_view> left_out{"color", "no-skip-empty", "probe-background", "cache"};
const std::set<std::string_view> first{"lighting", "strength", "probe", "probe-rotation", "probe-exposure", "floor"};

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text)
        if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '&')
            out += "&amp;";
        else if (c == '"')
            out += "&quot;";
        else if (static_cast<unsigned char>(c) < 128)
            out += c;
    return out;
}

/// "sh-bands": ChiaroShBands.
std::string property_of(std::string_view flag) {
    std::string name = "Chiaro";
    bool is_first = true;
    for (const char c : flag) {
        if (c != '-') name += is_first ? char(std::toupper(c)) : c;
        is_first = c == '-';
    }
    return name;
}

/// A property's XML, and its name for the panel's group.
class Panel {
public:
    std::string properties, names;

    template <class Field>
    void add(const Setting& s, const Field& field) {
        if constexpr (std::is_same_v<Field, bool>)
            begin(s, "Int", "SetSwitch", field ? "1" : "0"), properties += "<BooleanDomain name=\"bool\"/>";
        else if constexpr (std::is_same_v<Field, int>)
            begin(s, "Int", "SetSetting", to_text(field)), range(s, "Int");
        else if constexpr (std::is_same_v<Field, double>)
            begin(s, "Double", "SetSetting", to_text(field)), range(s, "Double");
        else if constexpr (Named<Field>)
            begin(s, "String", "SetSetting", to_text(field)), choices(field, false);
        else if constexpr (requires { requires Named<typename Field::value_type>; })
            begin(s, "String", "SetSetting", to_text(field)), choices(typename Field::value_type{}, true);
        else
            begin(s, "String", "SetSetting", to_text(field));
        std::string told(s.sentence);
        if (!s.unit.empty()) told += " (" + std::string(s.unit) + ")";
        if (!s.form.empty()) told += ": " + std::string(s.form);
        properties += "<Documentation>" + escaped(told) + "</Documentation></" + kind_ + "VectorProperty>\n";
    }

private:
    void begin(const Setting& s, const char* kind, const char* command, const std::string& value) {
        kind_ = kind;
        const std::string name = property_of(s.name);
        std::string label(s.name);
        for (char& c : label) c = c == '-' ? ' ' : c;
        label[0] = char(std::toupper(label[0]));
        properties += "<" + kind_ + "VectorProperty name=\"" + name + "\" label=\"" + label + "\" command=\"" +
                      command + "\" initial_string=\"" + std::string(s.name) +
                      "\" number_of_elements=\"1\" default_values=\"" + escaped(value) + "\" panel_visibility=\"" +
                      (first.contains(s.name) ? "default" : "advanced") + "\">";
        names += "<Property name=\"" + name + "\"/>\n";
    }
    void range(const Setting& s, const char* kind) {
        properties += std::string("<") + kind + "RangeDomain name=\"range\"";
        if (std::isfinite(s.lowest)) properties += " min=\"" + to_text(s.lowest) + "\"";
        if (std::isfinite(s.highest)) properties += " max=\"" + to_text(s.highest) + "\"";
        properties += "/>";
    }
    template <class Enum>
    void choices(Enum value, bool may_be_none) {
        properties += "<StringListDomain name=\"list\">";
        if (may_be_none) properties += "<String value=\"\"/>";
        for (const std::string_view name : names_of(value))
            properties += "<String value=\"" + std::string(name) + "\"/>";
        properties += "</StringListDomain>";
    }

    std::string kind_;
};

}  // namespace

int main() {
    Panel panel;
    Scene scene;
    for_each_group(
        [&](std::string_view group, auto& settings) {
            describe(
                [&](const Setting& s, const auto& field, const auto&...) {
                    if (s.name == "strength" || s.name == "interpolation" ||
                        (groups.contains(group) && !s.name.empty() && !left_out.contains(s.name)))
                        panel.add(s, field);
                },
                settings);
        },
        scene);
    std::printf(R"(<ServerManagerConfiguration>
<ProxyGroup name="representations">
<RepresentationProxy class="vtkChiaroRepresentation" name="ChiaroVolumeRepresentation" processes="client|renderserver|dataserver"
    si_class="vtkSIProxy" base_proxygroup="representations" base_proxyname="UniformGridVolumeRepresentation">
<Documentation>Image data in natural light.</Documentation>
%s<IntVectorProperty name="ChiaroGhostLevels" label="Ghost levels" command="SetGhostLevels" number_of_elements="1" default_values="16"
    panel_visibility="advanced"><IntRangeDomain name="range" min="0" max="64"/>
<Documentation>Layers of cells of its neighbours that each of several processes keeps: light is found from them, and the walls that rays have met.
</Documentation>
</IntVectorProperty>
<IntVectorProperty name="ChiaroValueOfRays" label="Value of rays" command="SetValueOfRays" number_of_elements="1" default_values="0">
<EnumerationDomain name="enum"><Entry value="0" text="None"/><Entry value="1" text="Maximum"/><Entry value="2" text="Minimum"/>
<Entry value="3" text="Average"/><Entry value="4" text="Additive"/></EnumerationDomain>
<Documentation>One value of each ray, or a sum along it, is shown in the place of the blend mode.</Documentation>
</IntVectorProperty>
<StringVectorProperty name="ChiaroScene" label="Scene file" command="SetScene" number_of_elements="1" default_values=""
    panel_visibility="advanced">
<Documentation>A scene of chiaro render, by a file of the server: it takes the place of colours, camera and all settings.</Documentation>
</StringVectorProperty>
<StringVectorProperty name="ChiaroFrameFile" label="Frame file" command="SetFrameFile" number_of_elements="1" default_values=""
    panel_visibility="never" state_ignored="1">
<Documentation>An .exr of the server that each picture's light is written to, too, as floats.</Documentation>
</StringVectorProperty>
<IntVectorProperty name="ChiaroExactCompositing" label="Exact compositing" command="SetExactCompositing" number_of_elements="1"
    default_values="0"><BooleanDomain name="bool"/>
<Documentation>Of several processes: their pictures are blended as floats rather than in the 8 bits of a window. Not beside other geometry.
</Documentation>
</IntVectorProperty>
</RepresentationProxy>
<Extension name="UniformGridRepresentation">
<RepresentationType subproxy="ChiaroRepresentation" text="Chiaro"/>
<SubProxy>
<Proxy name="ChiaroRepresentation" proxygroup="representations" proxyname="ChiaroVolumeRepresentation"/>
<ShareProperties subproxy="VolumeRepresentation"><Exception name="Input"/><Exception name="Visibility"/></ShareProperties>
<ExposedProperties>
<PropertyGroup label="Chiaro">
%s<Property name="ChiaroValueOfRays"/>
<Property name="ChiaroExactCompositing"/>
<Property name="ChiaroScene"/>
<Property name="ChiaroFrameFile"/>
<Property name="ChiaroGhostLevels"/>
<Hints><PropertyWidgetDecorator type="GenericDecorator" mode="visibility" property="Representation" value="Chiaro"/></Hints>
</PropertyGroup>
</ExposedProperties>
</SubProxy>
</Extension>
</ProxyGroup>
</ServerManagerConfiguration>
)",
                panel.properties.c_str(), panel.names.c_str());
}

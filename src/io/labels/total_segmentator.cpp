// The classes of TotalSegmentator's task "total" (version 2; Wasserthal et al. 2023), in the order of their values.
#include "io/labels/table.h"

namespace chiaro {

LabelTable total_segmentator() {
    LabelTable table{.labels = {}, .format = "TotalSegmentator", .notes = {}};
    const auto add = [&](const std::string& name) {
        const auto value = std::uint32_t(table.labels.size() + 1);
        table.labels.push_back({.value = value, .name = name, .rgb = label_color(value)});
    };
    const auto add_all = [&](std::initializer_list<const char*> names) {
        for (const char* name : names) add(name);
    };
    const auto add_down = [&](const char* spine, int from) {
        for (int number = from; number >= 1; --number) add(std::string("vertebrae_") + spine + std::to_string(number));
    };
    add_all({"spleen",
             "kidney_right",
             "kidney_left",
             "gallbladder",
             "liver",
             "stomach",
             "pancreas",
             "adrenal_gland_right",
             "adrenal_gland_left",
             "lung_upper_lobe_left",
             "lung_lower_lobe_left",
             "lung_upper_lobe_right",
             "lung_middle_lobe_right",
             "lung_lower_lobe_right",
             "esophagus",
             "trachea",
             "thyroid_gland",
             "small_bowel",
             "duodenum",
             "colon",
             "urinary_bladder",
             "prostate",
             "kidney_cyst_left",
             "kidney_cyst_right",
             "sacrum"});
    add_down("S", 1), add_down("L", 5), add_down("T", 12), add_down("C", 7);
    add_all({"heart", "aorta", "pulmonary_vein", "brachiocephalic_trunk", "subclavian_artery_right",
             "subclavian_artery_left", "common_carotid_artery_right", "common_carotid_artery_left",
             "brachiocephalic_vein_left", "brachiocephalic_vein_right", "atrial_appendage_left", "superior_vena_cava",
             "inferior_vena_cava", "portal_vein_and_splenic_vein", "iliac_artery_left", "iliac_artery_right",
             "iliac_vena_left", "iliac_vena_right"});
    for (const char* name : {"humerus", "scapula", "clavicula", "femur", "hip"})
        add(name + std::string("_left")), add(name + std::string("_right"));
    add("spinal_cord");
    for (const char* name : {"gluteus_maximus", "gluteus_medius", "gluteus_minimus", "autochthon", "iliopsoas"})
        add(name + std::string("_left")), add(name + std::string("_right"));
    add_all({"brain", "skull"});
    for (const char* side : {"left", "right"})
        for (int rib = 1; rib <= 12; ++rib) add("rib_" + std::string(side) + "_" + std::to_string(rib));
    add_all({"sternum", "costal_cartilages"});
    return table;
}

}  // namespace chiaro

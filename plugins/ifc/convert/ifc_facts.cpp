// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ifc_facts.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <set>
#include <sstream>
#include <unordered_map>

#include <ifcpp/IFC4/include/IfcAreaMeasure.h>
#include <ifcpp/IFC4/include/IfcBuildingStorey.h>
#include <ifcpp/IFC4/include/IfcConversionBasedUnit.h>
#include <ifcpp/IFC4/include/IfcCountMeasure.h>
#include <ifcpp/IFC4/include/IfcElement.h>
#include <ifcpp/IFC4/include/IfcElementQuantity.h>
#include <ifcpp/IFC4/include/IfcGloballyUniqueId.h>
#include <ifcpp/IFC4/include/IfcIdentifier.h>
#include <ifcpp/IFC4/include/IfcLabel.h>
#include <ifcpp/IFC4/include/IfcLengthMeasure.h>
#include <ifcpp/IFC4/include/IfcMapConversion.h>
#include <ifcpp/IFC4/include/IfcMeasureWithUnit.h>
#include <ifcpp/IFC4/include/IfcProduct.h>
#include <ifcpp/IFC4/include/IfcProject.h>
#include <ifcpp/IFC4/include/IfcProjectedCRS.h>
#include <ifcpp/IFC4/include/IfcPropertyEnumeratedValue.h>
#include <ifcpp/IFC4/include/IfcPropertySet.h>
#include <ifcpp/IFC4/include/IfcPropertySetDefinitionSet.h>
#include <ifcpp/IFC4/include/IfcPropertySingleValue.h>
#include <ifcpp/IFC4/include/IfcQuantityArea.h>
#include <ifcpp/IFC4/include/IfcQuantityCount.h>
#include <ifcpp/IFC4/include/IfcQuantityLength.h>
#include <ifcpp/IFC4/include/IfcQuantityVolume.h>
#include <ifcpp/IFC4/include/IfcRelAggregates.h>
#include <ifcpp/IFC4/include/IfcRelContainedInSpatialStructure.h>
#include <ifcpp/IFC4/include/IfcRelDefinesByProperties.h>
#include <ifcpp/IFC4/include/IfcRelDefinesByType.h>
#include <ifcpp/IFC4/include/IfcRelFillsElement.h>
#include <ifcpp/IFC4/include/IfcRelVoidsElement.h>
#include <ifcpp/IFC4/include/IfcOpeningElement.h>
#include <ifcpp/IFC4/include/IfcReal.h>
#include <ifcpp/IFC4/include/IfcSIPrefix.h>
#include <ifcpp/IFC4/include/IfcSIUnit.h>
#include <ifcpp/IFC4/include/IfcSite.h>
#include <ifcpp/IFC4/include/IfcSpatialElement.h>
#include <ifcpp/IFC4/include/IfcTypeObject.h>
#include <ifcpp/IFC4/include/IfcValue.h>
#include <ifcpp/IFC4/include/IfcVolumeMeasure.h>
#include <ifcpp/model/BuildingModel.h>

namespace alidade {

namespace {

template <class T>
std::string valueOf(const std::shared_ptr<T>& label) {
  return label ? utf8(label->m_value) : std::string();
}

/// A measure or label as it should be read: 'text' without quotes, .T. as true, 12. as 12.
std::string readable(const std::shared_ptr<IfcValue>& value) {
  if (!value) return {};
  std::stringstream step;
  step.precision(17);  // the library writes with what the stream has, and six digits lose a map's metres
  value->getStepParameter(step, false);
  const std::string text = step.str();
  if (text == ".T.") return "true";
  if (text == ".F.") return "false";
  if (text == ".U.") return "unknown";
  if (!text.empty() && text.front() == '\'') {
    if (const auto object = std::dynamic_pointer_cast<BuildingObject>(value)) return utf8(object->toString());
  }
  // Fewest digits that stand for the same number.
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (!text.empty() && end == text.c_str() + text.size() && std::isfinite(number)) {
    char digits[32];
    const auto [stop, code] = std::to_chars(digits, digits + sizeof digits, number);
    if (code == std::errc()) return std::string(digits, stop);
  }
  if (const auto object = std::dynamic_pointer_cast<BuildingObject>(value)) return utf8(object->toString());
  return text;
}

std::string number(double value) {
  char digits[32];
  const auto [stop, code] = std::to_chars(digits, digits + sizeof digits, value);
  return code == std::errc() ? std::string(digits, stop) : std::string();
}

using Properties = std::map<std::string, std::string>;
constexpr std::size_t kMostProperties = 1000;

void addPropertySet(const std::shared_ptr<IfcPropertySet>& set, Properties& out) {
  const std::string prefix = valueOf(set->m_Name) + ".";
  for (const auto& property : set->m_HasProperties) {
    if (!property || out.size() >= kMostProperties) continue;
    const std::string key = prefix + valueOf(property->m_Name);
    if (const auto single = std::dynamic_pointer_cast<IfcPropertySingleValue>(property)) {
      if (single->m_NominalValue) out.emplace(key, readable(single->m_NominalValue));
    } else if (const auto listed = std::dynamic_pointer_cast<IfcPropertyEnumeratedValue>(property)) {
      std::string text;
      for (const auto& value : listed->m_EnumerationValues) text += (text.empty() ? "" : ", ") + readable(value);
      out.emplace(key, text);
    }
  }
}

void addQuantities(const std::shared_ptr<IfcElementQuantity>& set, Properties& out) {
  const std::string prefix = valueOf(set->m_Name) + ".";
  for (const auto& quantity : set->m_Quantities) {
    if (!quantity || out.size() >= kMostProperties) continue;
    const std::string key = prefix + valueOf(quantity->m_Name);
    if (const auto q = std::dynamic_pointer_cast<IfcQuantityLength>(quantity); q && q->m_LengthValue)
      out.emplace(key, number(q->m_LengthValue->m_value));
    else if (const auto q = std::dynamic_pointer_cast<IfcQuantityArea>(quantity); q && q->m_AreaValue)
      out.emplace(key, number(q->m_AreaValue->m_value));
    else if (const auto q = std::dynamic_pointer_cast<IfcQuantityVolume>(quantity); q && q->m_VolumeValue)
      out.emplace(key, number(q->m_VolumeValue->m_value));
    else if (const auto q = std::dynamic_pointer_cast<IfcQuantityCount>(quantity); q && q->m_CountValue)
      out.emplace(key, number(q->m_CountValue->m_value));
  }
}

void addDefinition(const std::shared_ptr<IfcPropertySetDefinition>& definition, Properties& out) {
  if (const auto set = std::dynamic_pointer_cast<IfcPropertySet>(definition)) addPropertySet(set, out);
  else if (const auto quantities = std::dynamic_pointer_cast<IfcElementQuantity>(definition))
    addQuantities(quantities, out);
}

void addRelations(const std::vector<std::weak_ptr<IfcRelDefinesByProperties>>& relations, Properties& out) {
  for (const auto& weak : relations) {
    const auto relation = weak.lock();
    if (!relation || !relation->m_RelatingPropertyDefinition) continue;
    const auto& select = relation->m_RelatingPropertyDefinition;
    if (const auto one = std::dynamic_pointer_cast<IfcPropertySetDefinition>(select)) addDefinition(one, out);
    else if (const auto many = std::dynamic_pointer_cast<IfcPropertySetDefinitionSet>(select))
      for (const auto& each : many->m_vec) addDefinition(each, out);
  }
}

/// Own property sets first; the type's fill what they leave open (IFC4, IfcTypeObject: occurrence wins).
Properties propertiesOf(const IfcObject& object) {
  Properties out;
  addRelations(object.m_IsDefinedBy_inverse, out);
  for (const auto& weak : object.m_IsTypedBy_inverse) {
    const auto relation = weak.lock();
    if (!relation || !relation->m_RelatingType) continue;
    if (relation->m_RelatingType->m_Name) out.emplace("Type", valueOf(relation->m_RelatingType->m_Name));
    for (const auto& set : relation->m_RelatingType->m_HasPropertySets) addDefinition(set, out);
  }
  return out;
}

std::shared_ptr<IfcObjectDefinition> whole(const IfcObjectDefinition& part) {
  for (const auto& weak : part.m_Decomposes_inverse)
    if (const auto relation = weak.lock(); relation && relation->m_RelatingObject) return relation->m_RelatingObject;
  return nullptr;
}

std::shared_ptr<IfcObjectDefinition> container(const std::shared_ptr<IfcObjectDefinition>& object) {
  if (const auto element = std::dynamic_pointer_cast<IfcElement>(object)) {
    for (const auto& weak : element->m_ContainedInStructure_inverse)
      if (const auto relation = weak.lock(); relation && relation->m_RelatingStructure)
        return relation->m_RelatingStructure;
    // A door may be placed only by the opening it fills.
    for (const auto& weak : element->m_FillsVoids_inverse) {
      const auto fills = weak.lock();
      if (!fills || !fills->m_RelatingOpeningElement) continue;
      if (const auto voids = fills->m_RelatingOpeningElement->m_VoidsElements_inverse.lock();
          voids && voids->m_RelatingBuildingElement)
        return voids->m_RelatingBuildingElement;
    }
  }
  return whole(*object);
}

/// The nearest storey above; where there is none, the nearest spatial element that has a name.
std::string storeyOf(const std::shared_ptr<IfcProduct>& product) {
  std::string nearest;
  std::set<const void*> seen;
  std::shared_ptr<IfcObjectDefinition> at = container(product);
  while (at && seen.insert(at.get()).second) {
    const auto storey = std::dynamic_pointer_cast<IfcBuildingStorey>(at);
    if (storey) return valueOf(storey->m_Name);
    if (nearest.empty() && std::dynamic_pointer_cast<IfcSpatialElement>(at)) nearest = valueOf(at->m_Name);
    at = container(at);
  }
  return nearest;
}

Rgba8 defaultColour(const std::string& type) {
  static const std::pair<const char*, Rgba8> kColours[] = {
      {"IfcWall", {214, 205, 190, 255}},     {"IfcSlab", {176, 176, 172, 255}},
      {"IfcRoof", {160, 82, 66, 255}},       {"IfcColumn", {150, 160, 175, 255}},
      {"IfcBeam", {135, 150, 172, 255}},     {"IfcMember", {140, 130, 115, 255}},
      {"IfcPlate", {150, 190, 210, 170}},    {"IfcWindow", {140, 190, 225, 150}},
      {"IfcDoor", {150, 105, 65, 255}},      {"IfcStair", {190, 180, 165, 255}},
      {"IfcRailing", {110, 115, 120, 255}},  {"IfcFurni", {170, 135, 95, 255}},
      {"IfcCovering", {225, 220, 205, 255}}, {"IfcFooting", {140, 140, 135, 255}},
      {"IfcPile", {140, 140, 135, 255}},     {"IfcCurtainWall", {150, 190, 215, 170}},
      {"IfcPipe", {70, 130, 180, 255}},      {"IfcFlow", {70, 130, 180, 255}},
      {"IfcDuct", {95, 155, 160, 255}},      {"IfcDistribution", {70, 130, 180, 255}},
      {"IfcReinforc", {170, 90, 60, 255}},   {"IfcSite", {150, 170, 120, 255}},
  };
  for (const auto& [prefix, colour] : kColours)
    if (type.starts_with(prefix)) return colour;
  return {200, 200, 200, 255};
}

double prefixFactor(const std::shared_ptr<IfcSIPrefix>& prefix) {
  static const std::map<int, double> kPowers = {
      {IfcSIPrefix::ENUM_KILO, 1e3},   {IfcSIPrefix::ENUM_HECTO, 1e2},  {IfcSIPrefix::ENUM_DECA, 1e1},
      {IfcSIPrefix::ENUM_DECI, 1e-1},  {IfcSIPrefix::ENUM_CENTI, 1e-2}, {IfcSIPrefix::ENUM_MILLI, 1e-3},
      {IfcSIPrefix::ENUM_MICRO, 1e-6}, {IfcSIPrefix::ENUM_MEGA, 1e6}};
  if (!prefix) return 1;
  const auto found = kPowers.find(prefix->m_enum);
  return found == kPowers.end() ? 1 : found->second;
}

/// Metres of a length unit, conversion-based ones followed to their SI unit.
std::optional<double> metresOf(const std::shared_ptr<IfcNamedUnit>& unit) {
  if (const auto si = std::dynamic_pointer_cast<IfcSIUnit>(unit)) return prefixFactor(si->m_Prefix);
  const auto based = std::dynamic_pointer_cast<IfcConversionBasedUnit>(unit);
  if (!based || !based->m_ConversionFactor || !based->m_ConversionFactor->m_ValueComponent) return std::nullopt;
  const double factor = std::strtod(readable(based->m_ConversionFactor->m_ValueComponent).c_str(), nullptr);
  const auto si = std::dynamic_pointer_cast<IfcSIUnit>(based->m_ConversionFactor->m_UnitComponent);
  if (!(factor > 0) || !si) return std::nullopt;
  return factor * prefixFactor(si->m_Prefix);
}

/// The six numbers of a conversion as the file states them, in its map unit.
struct RawConversion {
  double e = 0, n = 0, h = 0, abscissa = 1, ordinate = 0;
  std::optional<double> scale, metresPerMapUnit;
  std::string crs, where;
};

std::optional<RawConversion> fromEntity(const BuildingModel& model) {
  for (const auto& [id, entity] : model.getMapIfcEntities()) {
    const auto map = std::dynamic_pointer_cast<IfcMapConversion>(entity);
    if (!map) continue;
    RawConversion raw;
    raw.where = "#" + std::to_string(id) + " IfcMapConversion";
    if (map->m_Eastings) raw.e = map->m_Eastings->m_value;
    if (map->m_Northings) raw.n = map->m_Northings->m_value;
    if (map->m_OrthogonalHeight) raw.h = map->m_OrthogonalHeight->m_value;
    if (map->m_XAxisAbscissa && map->m_XAxisOrdinate) {
      raw.abscissa = map->m_XAxisAbscissa->m_value;
      raw.ordinate = map->m_XAxisOrdinate->m_value;
    }
    if (map->m_Scale) raw.scale = map->m_Scale->m_value;
    if (map->m_TargetCRS) raw.crs = valueOf(map->m_TargetCRS->m_Name);
    if (const auto projected = std::dynamic_pointer_cast<IfcProjectedCRS>(map->m_TargetCRS))
      raw.metresPerMapUnit = metresOf(projected->m_MapUnit);
    return raw;
  }
  return std::nullopt;
}

std::optional<double> numberOf(const Properties& properties, const std::string& key) {
  const auto found = properties.find(key);
  if (found == properties.end()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(found->second.c_str(), &end);
  if (end == found->second.c_str()) return std::nullopt;
  return value;
}

std::optional<RawConversion> fromPropertySet(const BuildingModel& model) {
  for (const auto& [id, entity] : model.getMapIfcEntities()) {
    Properties properties;
    if (const auto site = std::dynamic_pointer_cast<IfcSite>(entity)) addRelations(site->m_IsDefinedBy_inverse, properties);
    else if (const auto project = std::dynamic_pointer_cast<IfcProject>(entity))
      addRelations(project->m_IsDefinedBy_inverse, properties);
    else continue;
    for (const std::string set : {"ePSet_MapConversion", "ePset_MapConversion", "EPset_MapConversion"}) {
      const auto e = numberOf(properties, set + ".Eastings"), n = numberOf(properties, set + ".Northings");
      if (!e || !n) continue;
      RawConversion raw;
      raw.where = "#" + std::to_string(id) + " " + set;
      raw.e = *e;
      raw.n = *n;
      raw.h = numberOf(properties, set + ".OrthogonalHeight").value_or(0);
      const auto abscissa = numberOf(properties, set + ".XAxisAbscissa");
      const auto ordinate = numberOf(properties, set + ".XAxisOrdinate");
      if (abscissa && ordinate) raw.abscissa = *abscissa, raw.ordinate = *ordinate;
      raw.scale = numberOf(properties, set + ".Scale");
      for (const std::string crs : {"ePSet_ProjectedCRS", "ePset_ProjectedCRS", "EPset_ProjectedCRS"})
        if (const auto name = properties.find(crs + ".Name"); name != properties.end()) raw.crs = name->second;
      return raw;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string utf8(const std::wstring& text) {
  std::string out;
  for (const wchar_t wide : text) {
    auto c = static_cast<std::uint32_t>(wide);
    if (c < 0x20 && c != '\t') c = ' ';
    if (c > 0x10FFFF || (c >= 0xD800 && c < 0xE000)) c = 0xFFFD;
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xC0 | (c >> 6));
      out += static_cast<char>(0x80 | (c & 0x3F));
    } else if (c < 0x10000) {
      out += static_cast<char>(0xE0 | (c >> 12));
      out += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
      out += static_cast<char>(0x80 | (c & 0x3F));
    } else {
      out += static_cast<char>(0xF0 | (c >> 18));
      out += static_cast<char>(0x80 | ((c >> 12) & 0x3F));
      out += static_cast<char>(0x80 | ((c >> 6) & 0x3F));
      out += static_cast<char>(0x80 | (c & 0x3F));
    }
  }
  return out;
}

DesignElement describeProduct(const std::shared_ptr<IfcProduct>& product) {
  DesignElement element;
  element.globalId = valueOf(product->m_GlobalId);
  element.name = valueOf(product->m_Name);
  element.type = product->className();
  if (element.name.empty()) element.name = element.type + " #" + std::to_string(product->m_entity_id);
  if (element.globalId.empty()) element.globalId = "#" + std::to_string(product->m_entity_id);
  element.storey = storeyOf(product);
  element.colour = defaultColour(element.type);
  element.properties = propertiesOf(*product);
  if (product->m_ObjectType && !product->m_ObjectType->m_value.empty())
    element.properties.emplace("ObjectType", valueOf(product->m_ObjectType));
  return element;
}

MapConversion readMapConversion(const BuildingModel& model, double metresPerUnit, std::vector<ConversionNote>& notes) {
  MapConversion conversion;
  auto raw = fromEntity(model);
  if (!raw) raw = fromPropertySet(model);
  if (!raw) return conversion;
  const double metresPerMapUnit = raw->metresPerMapUnit.value_or(metresPerUnit);
  const double length = std::hypot(raw->abscissa, raw->ordinate);
  const bool finite = std::isfinite(raw->e) && std::isfinite(raw->n) && std::isfinite(raw->h);
  if (!finite || !(length > 0) || !std::isfinite(length) || (raw->scale && !(*raw->scale > 0))) {
    notes.push_back({"The map conversion has impossible numbers and was left out: the design is not georeferenced",
                     raw->where});
    return conversion;
  }
  conversion.present = true;
  conversion.crs = raw->crs;
  conversion.offset = glm::dvec3(raw->e, raw->n, raw->h) * metresPerMapUnit;
  conversion.cosine = raw->abscissa / length;
  conversion.sine = raw->ordinate / length;
  // Scale takes project units to map units; in metres it must be near one.
  const double scale = raw->scale.value_or(1.0);
  conversion.scale = scale * metresPerMapUnit / metresPerUnit;
  if (std::abs(conversion.scale - 1) > 0.05 && std::abs(scale - 1) < 0.05) {
    conversion.scale = scale;
    notes.push_back({"The map conversion's scale ignores that project and map have different units; "
                     "it was taken as a scale between metres", raw->where});
  }
  if (!raw->metresPerMapUnit && std::abs(metresPerUnit - 1) > 1e-9)
    notes.push_back({"The map conversion names no unit; its eastings and northings were taken in the project's unit",
                     raw->where});
  return conversion;
}

}  // namespace alidade

// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// alidade-ifc-convert FILE
//
// Reads one IFC file with ifcplusplus and sends it to descriptor 3 as a design stream
// (plugin_api/child_process.h, survey/design_stream.h). Runs with limits on memory and time; whatever
// the library does on a bad file happens here and not in Alidade.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <unordered_set>

#include <unistd.h>

#include <fmt/format.h>

#include <ifcpp/IFC4/include/IfcAnnotation.h>
#include <ifcpp/IFC4/include/IfcFeatureElementSubtraction.h>
#include <ifcpp/IFC4/include/IfcGeometricRepresentationContext.h>
#include <ifcpp/IFC4/include/IfcGrid.h>
#include <ifcpp/IFC4/include/IfcProject.h>
#include <ifcpp/IFC4/include/IfcSpace.h>
#include <ifcpp/IFC4/include/IfcVirtualElement.h>
#include <ifcpp/geometry/Carve/GeometryConverter.h>
#include <ifcpp/model/BuildingModel.h>
#include <ifcpp/reader/ReaderSTEP.h>

#include "ifc_facts.h"
#include "plugin_api/child_process.h"
#include "survey/design_builder.h"
#include "survey/design_stream.h"

namespace alidade {

namespace {

using Triangle = std::array<glm::dvec3, 3>;
using MeshSet = carve::mesh::MeshSet<3>;

constexpr double kMostChordErrorM = 0.001;  ///< of circles drawn as polygons

struct Tally {
  std::map<int, std::string> messages;  ///< entity id -> first complaint of the library
  std::size_t notDrawn = 0, faults = 0;
};

struct Context {
  ChildReporter& reporter;
  Tally tally;
};

void onMessage(void* pointer, std::shared_ptr<StatusCallback::Message> message) {
  auto& context = *static_cast<Context*>(pointer);
  if (!message) return;
  if (message->m_message_type == StatusCallback::MESSAGE_TYPE_PROGRESS_VALUE) {
    const bool geometry = message->m_progress_type == "geometry";
    const double part = std::clamp(message->m_progress_value, 0.0, 1.0);
    context.reporter.progress(geometry ? 0.3 + 0.6 * part : 0.3 * part,
                              geometry ? "Making the design's surfaces" : "Reading the design");
  } else if (message->m_message_type == StatusCallback::MESSAGE_TYPE_ERROR) {
    const int id = message->m_entity ? message->m_entity->m_entity_id : 0;
    if (context.tally.messages.size() < 1000) context.tally.messages.emplace(id, utf8(message->m_message_text));
  }
}

glm::dvec3 toGlm(const carve::geom::vector<3>& v) { return {v.x, v.y, v.z}; }

/// A fan or carve's ear clipping in the plane that the face is seen best in.
void triangulateFace(const carve::mesh::Face<3>& face, std::vector<Triangle>& out) {
  std::vector<glm::dvec3> corner;
  const carve::mesh::Edge<3>* edge = face.edge;
  for (std::size_t i = 0; i < face.n_edges && edge; ++i, edge = edge->next) corner.push_back(toGlm(edge->vert->v));
  if (corner.size() < 3) return;
  if (corner.size() == 3) {
    out.push_back({corner[0], corner[1], corner[2]});
    return;
  }
  glm::dvec3 normal(0);  // Newell's
  for (std::size_t i = 0; i < corner.size(); ++i)
    normal += glm::cross(corner[i] - corner[0], corner[(i + 1) % corner.size()] - corner[0]);
  const double length = glm::length(normal);
  if (!(length > 0)) return;
  normal /= length;
  const glm::dvec3 helper = std::abs(normal.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, normal)), y = glm::cross(normal, x);
  std::vector<carve::geom2d::P2> flat;
  for (const glm::dvec3& c : corner)
    flat.push_back(carve::geom::VECTOR(glm::dot(c - corner[0], x), glm::dot(c - corner[0], y)));
  std::vector<carve::triangulate::tri_idx> triangles;
  carve::triangulate::triangulate(flat, triangles);
  for (const auto& t : triangles) {
    Triangle made{corner.at(t.a), corner.at(t.b), corner.at(t.c)};
    // carve's winding follows its own idea of up.
    if (glm::dot(glm::cross(made[1] - made[0], made[2] - made[0]), normal) < 0) std::swap(made[1], made[2]);
    out.push_back(made);
  }
}

bool finite(const Triangle& t) {
  for (const glm::dvec3& v : t)
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
  return true;
}

struct Shell {
  std::vector<Triangle> triangles;
  Bounds box;
  double volume = 0;      ///< six times, signed
  bool solid = false;     ///< closed, or nearly so: the sign of the volume tells inside from outside
};

/// A void within a solid is a shell of its own and faces inwards; every other solid faces outwards.
void turnOutwards(std::vector<Shell>& shells) {
  for (Shell& shell : shells) {
    if (!shell.solid || shell.volume >= 0) continue;
    const bool isVoid = std::any_of(shells.begin(), shells.end(), [&](const Shell& other) {
      return &other != &shell && other.solid && std::abs(other.volume) > std::abs(shell.volume) &&
             other.box.contains(shell.box.min) && other.box.contains(shell.box.max);
    });
    if (isVoid) continue;
    for (Triangle& t : shell.triangles) std::swap(t[1], t[2]);
    shell.volume = -shell.volume;
  }
}

/// The meshes of one set in the product's own coordinates, wound outwards where they are solids.
std::vector<Triangle> trianglesOf(const MeshSet& set, Tally& tally) {
  std::vector<Shell> shells;
  for (const auto* mesh : set.meshes) {
    if (!mesh) continue;
    Shell shell;
    for (const auto* face : mesh->faces)
      if (face) triangulateFace(*face, shell.triangles);
    const std::size_t before = shell.triangles.size();
    std::erase_if(shell.triangles, [](const Triangle& t) { return !finite(t); });
    if (shell.triangles.size() != before) ++tally.faults;
    for (const Triangle& t : shell.triangles)
      for (const glm::dvec3& corner : t) shell.box.add(corner);
    shell.volume = sixfoldVolume(shell.triangles);
    // A solid that lost a sliver in a subtraction has a few open edges and still an inside.
    shell.solid = mesh->open_edges.size() * 10 < mesh->closed_edges.size();
    shells.push_back(std::move(shell));
  }
  turnOutwards(shells);
  std::vector<Triangle> all;
  for (const Shell& shell : shells) all.insert(all.end(), shell.triangles.begin(), shell.triangles.end());
  return all;
}

/// Representations that are no bodies (IFC4, IfcShapeRepresentation, RepresentationIdentifier).
bool isBody(const RepresentationData& representation) {
  static const std::set<std::wstring> kOther = {L"Axis",      L"Box",       L"FootPrint", L"Annotation", L"Profile",
                                                L"Clearance", L"Lighting",  L"CoG",       L"Reference",  L"Plan",
                                                L"SurveyPoints"};
  return !kOther.contains(representation.m_representation_identifier);
}

std::optional<Rgba8> colourOf(const std::vector<std::shared_ptr<AppearanceData>>& appearances) {
  for (const auto& appearance : appearances) {
    if (!appearance) continue;
    const auto kind = appearance->m_apply_to_geometry_type;
    if (kind == AppearanceData::GEOM_TYPE_CURVE || kind == AppearanceData::GEOM_TYPE_TEXT) continue;
    const auto channel = [](double value) {
      return static_cast<std::uint8_t>(std::lround(255 * std::clamp(std::isfinite(value) ? value : 0.8, 0.0, 1.0)));
    };
    const vec4& c = appearance->m_color_diffuse;
    return Rgba8{channel(c.r()), channel(c.g()), channel(c.b()), channel(appearance->m_transparency)};
  }
  return std::nullopt;
}

double area(const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
  return sum;
}

/// One colour an element: that of the largest surface among its items, glass counting by its opacity (a
/// window is known by its frame).
class ColourVote {
 public:
  void add(const std::optional<Rgba8>& colour, double areaM2) {
    if (!colour) return;
    m_area[std::bit_cast<std::uint32_t>(*colour)] += areaM2 * colour->a;
  }
  std::optional<Rgba8> winner() const {
    const auto best = std::max_element(m_area.begin(), m_area.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (best == m_area.end()) return std::nullopt;
    return std::bit_cast<Rgba8>(best->first);
  }

 private:
  std::map<std::uint32_t, double> m_area;
};

struct World {
  carve::math::Matrix context;  ///< the representation context's world coordinate system
  MapConversion map;

  glm::dvec3 operator()(const carve::math::Matrix& placement, const glm::dvec3& p) const {
    const carve::geom::vector<3> placed = context * (placement * carve::geom::VECTOR(p.x, p.y, p.z));
    return map(toGlm(placed));
  }
};

bool isDrawn(const std::shared_ptr<IfcProduct>& product) {
  return !std::dynamic_pointer_cast<IfcSpace>(product) &&
         !std::dynamic_pointer_cast<IfcFeatureElementSubtraction>(product) &&
         !std::dynamic_pointer_cast<IfcAnnotation>(product) && !std::dynamic_pointer_cast<IfcGrid>(product) &&
         !std::dynamic_pointer_cast<IfcVirtualElement>(product);
}

void addProduct(ProductShapeData& shape, const std::shared_ptr<IfcProduct>& product, const World& world,
                DesignBuilder& builder, Tally& tally) {
  builder.beginElement(describeProduct(product));
  const carve::math::Matrix placement = shape.getTransform();
  ColourVote vote;
  for (const auto& representation : shape.m_vec_representations) {
    if (!representation || !isBody(*representation)) continue;
    for (const auto& item : representation->m_vec_item_data) {
      if (!item) continue;
      auto colour = colourOf(item->m_vec_item_appearances);
      if (!colour) colour = colourOf(representation->m_vec_representation_appearances);
      if (!colour) colour = colourOf(shape.getAppearances());
      for (const auto* sets : {&item->m_meshsets, &item->m_meshsets_open}) {
        for (const auto& set : *sets) {
          if (!set) continue;
          const std::vector<Triangle> triangles = trianglesOf(*set, tally);
          vote.add(colour, area(triangles));
          for (const Triangle& t : triangles)
            builder.addTriangle(world(placement, t[0]), world(placement, t[1]), world(placement, t[2]));
        }
      }
    }
  }
  if (builder.triangleCount() == 0) {
    builder.dropElement();
  } else if (const auto colour = vote.winner()) {
    builder.setColour(*colour);
  }
}

World worldOf(GeometryConverter& converter, BuildingModel& model, double metresPerUnit,
              std::vector<ConversionNote>& notes) {
  World world;
  if (const auto context = model.getIfcGeometricRepresentationContext3D()) {
    std::shared_ptr<TransformData> matrix;
    std::unordered_set<IfcRepresentationContext*> applied;
    const std::shared_ptr<IfcRepresentationContext> base = context;
    converter.getRepresentationConverter()->getPlacementConverter()->getWorldCoordinateSystem(base, matrix, applied);
    if (matrix) world.context = matrix->m_matrix;
  }
  world.map = readMapConversion(model, metresPerUnit, notes);
  return world;
}

void addNotes(const Tally& tally, const DesignBuilder::Summary& summary, std::vector<ConversionNote>& notes) {
  const auto note = [&](std::size_t count, const char* what) {
    if (count) notes.push_back({fmt::format("{} {}", count, what), {}});
  };
  note(tally.notDrawn, "spaces, openings, annotations and grids are not drawn");
  note(tally.faults, "surfaces had corners that are no numbers; those were left out");
  note(summary.notFinite, "triangles lie beyond all bounds and were left out");
  note(summary.emptyElements, "elements had surfaces without area and were left out");
  constexpr std::size_t kShown = 20;
  std::size_t shown = 0;
  for (const auto& [id, text] : tally.messages) {
    if (++shown > kShown) break;
    notes.push_back({"The geometry may be incomplete: " + text, id > 0 ? fmt::format("#{}", id) : std::string()});
  }
  if (tally.messages.size() > kShown)
    notes.push_back({fmt::format("{} more remarks of this kind", tally.messages.size() - kShown), {}});
}

Result<DesignStream> convert(const std::string& path, Context& context) {
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.good() && !file.eof()) return fail("The file could not be read", path);

  auto model = std::make_shared<BuildingModel>();
  ReaderSTEP reader;
  reader.setMessageCallBack(&context, &onMessage);
  reader.loadModelFromString(text, model);
  std::string().swap(text);
  if (model->getMapIfcEntities().empty())
    return fail("The file holds no entity that could be read", path, "Export it again");
  if (!model->getIfcProject())
    return fail("The file holds no IfcProject", path, "Export the whole model, not a part of it");

  GeometryConverter converter(model);
  converter.setMessageCallBack(&context, &onMessage);
  converter.getGeomSettings()->setNumVerticesPerCircle(24);
  converter.getGeomSettings()->setNumVerticesPerCircleGivenRadius([](double radius) {
    if (!(radius > 2 * kMostChordErrorM)) return 12;
    const double step = 2 * std::acos(1 - kMostChordErrorM / radius);
    return static_cast<int>(std::clamp(std::ceil(2 * M_PI / step), 16.0, 96.0));
  });
  converter.convertGeometry();

  DesignStream stream;
  const double metresPerUnit = model->getUnitConverter()->getLengthInMeterFactor();
  const World world = worldOf(converter, *model, metresPerUnit, stream.notes);
  DesignBuilder builder;
  const auto& shapes = converter.getShapeInputData();
  std::size_t at = 0;
  for (const auto& [id, shape] : shapes) {
    context.reporter.progress(0.9 + 0.1 * static_cast<double>(at++) / static_cast<double>(shapes.size()),
                              "Collecting the design's elements");
    if (!shape || shape->m_vec_representations.empty()) continue;
    const auto product = std::dynamic_pointer_cast<IfcProduct>(shape->m_ifc_object_definition.lock());
    if (!product) continue;
    if (isDrawn(product)) addProduct(*shape, product, world, builder, context.tally);
    else ++context.tally.notDrawn;
  }
  DesignBuilder::Summary summary;
  auto made = builder.finish(summary);
  if (!made) return fail(made.error().in(path));
  stream.model = std::move(*made);
  stream.model.crs = world.map.crs;
  addNotes(context.tally, summary, stream.notes);
  return stream;
}

int run(const std::string& path) {
  ChildReporter reporter;
  Context context{reporter, {}};
  try {
    auto stream = convert(path, context);
    if (!stream) return reporter.fail(stream.error());
    return reporter.done(encodeDesign(*stream));
  } catch (const std::bad_alloc&) {
    return reporter.fail({"The converter needed more memory than it may take for this file", path,
                          "Split the model, or export it with fewer details"});
  } catch (const OutOfMemoryException&) {
    return reporter.fail({"The converter needed more memory than it may take for this file", path,
                          "Split the model, or export it with fewer details"});
  } catch (const BuildingException& e) {
    return reporter.fail({fmt::format("The file could not be converted: {}", e.what()), path, "Export it again"});
  } catch (const std::exception& e) {
    return reporter.fail({fmt::format("The file could not be converted: {}", e.what()), path, "Export it again"});
  } catch (...) {
    return reporter.fail({"The file could not be converted", path, "Export it again"});
  }
}

}  // namespace

}  // namespace alidade

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  // No destructors: the library's object graph takes longer to tear down than to convert.
  ::_exit(alidade::run(argv[1]));
}

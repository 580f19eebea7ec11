// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "metashape/metashape_reader.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "metashape/metashape_sensor.h"
#include "plugin_api/import_slip.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t(256) << 20;
constexpr int kMaxGroupDepth = 16;
const std::string kAdvice = "Export the cameras from Metashape again";

/// pInWorld = scale rotation pInLocal + translation
struct Similarity {
  double scale = 1;
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 translation{0};
};

glm::dmat3 matrixOfRows(const std::vector<double>& v, std::size_t stride) {
  glm::dmat3 m;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) m[int(c)][int(r)] = v[r * stride + c];
  return m;
}

/// A `<transform>` of rotation, translation and scale; nothing where there is none.
Result<std::optional<Similarity>> similarityOf(const pugi::xml_node& node, const std::string& where) {
  if (!node || !node.child("rotation") || !node.child("translation")) return std::optional<Similarity>();
  const auto rotation = metashapeNumbers(node.child("rotation"), 9, "the transform's rotation", where);
  if (!rotation) return fail(rotation.error());
  const auto translation = metashapeNumbers(node.child("translation"), 3, "the transform's translation", where);
  if (!translation) return fail(translation.error());
  Similarity s;
  if (node.child("scale")) {
    const auto scale = metashapeNumbers(node.child("scale"), 1, "the transform's scale", where);
    if (!scale) return fail(scale.error());
    s.scale = scale->front();
  }
  const auto turned = nearestRotation(matrixOfRows(*rotation, 3));
  if (!turned) return fail("The transform's rotation is no rotation", where, kAdvice);
  if (!(s.scale > 1e-12 && s.scale < 1e12)) return fail(fmt::format("The transform's scale {} is impossible", s.scale), where, kAdvice);
  s.rotation = *turned;
  s.translation = {(*translation)[0], (*translation)[1], (*translation)[2]};
  return std::optional<Similarity>(s);
}

/// One chunk on its way into a CameraSet.
class ChunkReader {
 public:
  ChunkReader(const pugi::xml_node& chunk, const std::string& path) : m_chunk(chunk), m_path(path) {
    m_where = fmt::format("{}, chunk {}", path, quotedWords(chunk.attribute("label").as_string()));
  }

  Result<CameraSet> read(const Progress& progress) {
    if (auto done = readSensors(); !done) return fail(done.error());
    if (auto done = readTransforms(); !done) return fail(done.error());
    if (auto done = readCameras(m_chunk.child("cameras"), 0, progress); !done) return fail(done.error());
    if (auto done = checkReference(); !done) return fail(done.error());
    tellSlips();
    m_set.details = fmt::format("Metashape: {} sensors, {} posed cameras", m_set.cameras.size(), m_set.pictures.size());
    return std::move(m_set);
  }

 private:
  Result<void> readSensors() {
    for (const pugi::xml_node node : m_chunk.child("sensors").children("sensor")) {
      auto sensor = metashapeSensor(node, m_path);
      if (!sensor) return fail(sensor.error());
      Entry entry{-1, std::move(*sensor)};
      if (entry.sensor.intrinsics) {
        entry.index = static_cast<int>(m_set.cameras.size());
        m_set.cameras.push_back(*entry.sensor.intrinsics);
      }
      if (!m_sensors.emplace(node.attribute("id").as_string(), std::move(entry)).second)
        return fail(fmt::format("The sensor {} comes twice", quotedWords(node.attribute("id").as_string())), m_where, kAdvice);
    }
    return {};
  }

  Result<void> readTransforms() {
    auto own = similarityOf(m_chunk.child("transform"), m_where);
    if (!own) return fail(own.error());
    m_chunkTransform = *own;
    const auto components = m_chunk.child("components");
    for (const pugi::xml_node node : components.children("component")) {
      const std::string id = node.attribute("id").as_string();
      auto transform = similarityOf(node.child("transform"), fmt::format("{}, component {}", m_where, quotedWords(id)));
      if (!transform) return fail(transform.error());
      // A component on its own has the chunk's transform, and so has the active one.
      const bool active = id == components.attribute("active_id").as_string() || (!node.next_sibling("component") && !node.previous_sibling("component"));
      m_components[id] = *transform || !active ? *transform : m_chunkTransform;
    }
    return {};
  }

  /// Cameras, and the groups that hold further ones.
  Result<void> readCameras(const pugi::xml_node& list, int depth, const Progress& progress) {
    if (depth > kMaxGroupDepth) return fail("Groups of cameras are nested too deep", m_where, kAdvice);
    for (const pugi::xml_node node : list.children()) {
      if (progress.cancelled()) return fail(cancelledError());
      const std::string_view name = node.name();
      if (name == "group") {
        if (auto done = readCameras(node, depth + 1, progress); !done) return done;
      } else if (name == "camera") {
        if (auto done = readCamera(node); !done) return done;
      }
    }
    return {};
  }

  Result<void> readCamera(const pugi::xml_node& node) {
    const std::string label = node.attribute("label").as_string();
    const std::string where = fmt::format("{}, camera {}", m_where, quotedWords(label));
    if (!node.attribute("enabled").as_bool(true)) return m_disabled.note(where), Result<void>();
    if (node.attribute("master_id") && !node.child("transform")) return m_slaves.note(where), Result<void>();
    if (!node.child("transform")) return m_unposed.note(where), Result<void>();
    if (label.empty()) return fail("A camera has no label", where, kAdvice);
    const auto sensor = m_sensors.find(node.attribute("sensor_id").as_string());
    if (sensor == m_sensors.end()) return fail("The camera's sensor is not in the chunk", where, kAdvice);
    if (sensor->second.index < 0) {
      m_uncovered[sensor->first].note(where);
      return {};
    }
    const auto transform = transformOf(node);
    if (!transform) return m_placeless.note(where), Result<void>();

    const auto values = metashapeNumbers(node.child("transform"), 16, "the camera's transform", where);
    if (!values) return fail(values.error());
    const auto chunkFromCamera = nearestRotation(matrixOfRows(*values, 4));
    if (!chunkFromCamera) return fail("The camera's transform holds no rotation", where, kAdvice);
    const glm::dvec3 centreInChunk((*values)[3], (*values)[7], (*values)[11]);
    RigidTransform worldFromCamera;
    worldFromCamera.rotation = glm::normalize(transform->rotation * *chunkFromCamera);
    worldFromCamera.translation = transform->scale * (transform->rotation * centreInChunk) + transform->translation;
    if (!worldFromCamera.isFinite()) return fail("The camera's position is not finite", where, kAdvice);

    PosedPicture picture;
    picture.name = label;
    picture.camera = sensor->second.index;
    picture.cameraFromWorld = worldFromCamera.inverse();
    if (!picture.cameraFromWorld->isFinite()) return fail("The camera's position is not finite", where, kAdvice);
    if (sensor->second.sensor.rollingShutter) m_rolling.note(where);
    const auto orientation = parseInteger(node.child("orientation").child_value());
    if (orientation && *orientation > 1) m_turned.note(where);
    m_set.pictures.push_back(std::move(picture));
    m_centres.push_back(worldFromCamera.translation);
    return {};
  }

  /// Nothing where the camera's component is not placed in the world, though others are.
  std::optional<Similarity> transformOf(const pugi::xml_node& camera) {
    const auto id = camera.attribute("component_id");
    const auto component = m_components.find(id.as_string());
    const auto& found = id && component != m_components.end() ? component->second : m_chunkTransform;
    if (found) return found;
    const bool anyPlaced = m_chunkTransform || std::any_of(m_components.begin(), m_components.end(), [](const auto& c) { return c.second; });
    if (anyPlaced) return std::nullopt;
    m_unscaled = true;
    return Similarity{};
  }

  /// A chunk's transform leads to its local system, but for any other reference to earth-centred
  /// coordinates, whatever the reference is called.
  Result<void> checkReference() {
    const std::string reference(trimmed(m_chunk.child("reference").child_value()));
    if (m_unscaled)
      m_set.warnings.push_back({"The chunk has no transform to the world: positions are in its own arbitrary units, not metres", m_where});
    if (reference.empty() || reference.starts_with("LOCAL_CS") || m_unscaled || m_centres.empty()) return {};
    const double fromEarthsCentre = glm::length(m_centres.front());
    if (fromEarthsCentre > 6.3e6 && fromEarthsCentre < 6.5e6)
      return fail("The chunk is georeferenced (" + quotedWords(reference, 60) + "): its transform leads to earth-centred coordinates", m_where,
                  "Set the chunk's reference to local coordinates in the survey's system and export again, or export in COLMAP's format");
    m_set.warnings.push_back({"The chunk states the reference " + quotedWords(reference, 60) +
                                  ": positions are taken as they stand. Check that they agree with the survey", m_where});
    return {};
  }

  void tellSlips() {
    auto& warnings = m_set.warnings;
    m_unposed.tell(warnings, "cameras have no transform (not aligned) and were left out");
    m_disabled.tell(warnings, "cameras are disabled and were left out");
    m_slaves.tell(warnings, "cameras take their pose from another one of a multi-camera system and were left out");
    m_placeless.tell(warnings, "cameras are in a component that is not placed in the world and were left out");
    m_rolling.tell(warnings, "cameras have a rolling shutter, which was passed over");
    m_turned.tell(warnings, "pictures are marked as turned; the pose is of the picture as stored");
    for (const auto& [id, slip] : m_uncovered)
      slip.tell(warnings, fmt::format("cameras of sensor {} were left out: {}", quotedWords(id), m_sensors.at(id).sensor.refusal));
  }

  struct Entry {
    int index = -1;  // into CameraSet::cameras
    MetashapeSensor sensor;
  };

  const pugi::xml_node m_chunk;
  const std::string& m_path;
  std::string m_where;
  CameraSet m_set;
  std::map<std::string, Entry> m_sensors;
  std::map<std::string, std::optional<Similarity>> m_components;
  std::optional<Similarity> m_chunkTransform;
  bool m_unscaled = false;
  std::vector<glm::dvec3> m_centres;
  ImportSlip m_unposed, m_disabled, m_slaves, m_placeless, m_rolling, m_turned;
  std::map<std::string, ImportSlip> m_uncovered;  // by sensor
};

}  // namespace

Result<CameraSet> parseMetashape(const std::string& text, const std::string& path, const Progress& progress) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_auto);
  if (!parsed)
    return fail(fmt::format("The XML is damaged: {}", parsed.description()), fmt::format("{}, byte {}", path, parsed.offset), kAdvice);
  const auto root = document.child("document");
  if (!root.child("chunk")) return fail("The XML holds no chunk of cameras", path, "Choose a file that Metashape's Export Cameras wrote");

  std::optional<CameraSet> chosen;
  std::size_t further = 0;
  for (const pugi::xml_node chunk : root.children("chunk")) {
    if (chosen && !chosen->pictures.empty()) {
      ++further;
      continue;
    }
    auto set = ChunkReader(chunk, path).read(progress);
    if (!set) return fail(set.error());
    chosen = std::move(*set);
  }
  if (chosen->cameras.empty() && chosen->pictures.empty())
    return fail("The XML holds no camera that can be used" + (chosen->warnings.empty() ? std::string() : ": " + chosen->warnings.front().what),
                path, "Align the pictures in Metashape and export the cameras again");
  if (further > 0) chosen->warnings.push_back({fmt::format("{} further chunks were passed over", further), path});
  return std::move(*chosen);
}

ReaderDescription MetashapeReader::description() const { return {"metashape", "Metashape cameras", {"xml"}}; }

int MetashapeReader::sniff(const FileProbe& probe) const {
  return !probe.isFolder && probe.holds("<document version") && probe.holds("<chunk") ? 85 : 0;
}

Result<CameraSet> MetashapeReader::inspect(const std::string& path) const { return read(path, Progress()); }

Result<CameraSet> MetashapeReader::read(const std::string& path, const Progress& progress) const {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return fail(text.error());
  return parseMetashape(*text, path, progress);
}

}  // namespace alidade

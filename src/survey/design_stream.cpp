// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/design_stream.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

namespace alidade {

namespace {

static_assert(std::endian::native == std::endian::little, "the stream is the memory's own byte order");

constexpr std::uint32_t kMagic = 0x53444C41;  // "ALDS"
constexpr std::uint32_t kVersion = 1;

class Writer {
 public:
  template <class T>
  void put(const T& value) requires std::is_trivially_copyable_v<T> {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    m_bytes.insert(m_bytes.end(), from, from + sizeof(T));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    const auto* from = reinterpret_cast<const std::byte*>(text.data());
    m_bytes.insert(m_bytes.end(), from, from + text.size());
  }
  template <class T>
  void putArray(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    const auto* from = reinterpret_cast<const std::byte*>(values.data());
    m_bytes.insert(m_bytes.end(), from, from + values.size() * sizeof(T));
  }
  std::vector<std::byte> take() { return std::move(m_bytes); }

 private:
  std::vector<std::byte> m_bytes;
};

/// Reads until something does not fit; from then on everything is zero and `good()` is false.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : m_bytes(bytes) {}

  template <class T>
  T get() requires std::is_trivially_copyable_v<T> {
    T value{};
    if (const std::byte* from = take(sizeof(T))) std::memcpy(&value, from, sizeof(T));
    return value;
  }
  std::string text() {
    const auto size = get<std::uint32_t>();
    const std::byte* from = take(size);
    return from ? std::string(reinterpret_cast<const char*>(from), size) : std::string();
  }
  template <class T>
  std::vector<T> array() {
    const auto count = get<std::uint64_t>();
    std::vector<T> values;
    if (count > m_bytes.size() / sizeof(T)) m_good = false;
    if (!m_good) return values;
    const std::byte* from = take(count * sizeof(T));
    values.resize(count);
    if (count) std::memcpy(values.data(), from, count * sizeof(T));
    return values;
  }
  /// A count of things that take at least `leastBytes` each.
  std::uint64_t count(std::size_t leastBytes) {
    const auto value = get<std::uint64_t>();
    if (value > m_bytes.size() / leastBytes) m_good = false;
    return m_good ? value : 0;
  }
  bool good() const { return m_good; }
  bool atEnd() const { return m_bytes.empty(); }

 private:
  const std::byte* take(std::size_t size) {
    if (!m_good || size > m_bytes.size()) {
      m_good = false;
      return nullptr;
    }
    const std::byte* from = m_bytes.data();
    m_bytes = m_bytes.subspan(size);
    return from;
  }
  std::span<const std::byte> m_bytes;
  bool m_good = true;
};

void putElement(Writer& out, const DesignElement& element) {
  for (const std::string* text : {&element.globalId, &element.name, &element.type, &element.storey}) out.put(*text);
  out.put(element.colour);
  out.put(static_cast<std::uint64_t>(element.properties.size()));
  for (const auto& [key, value] : element.properties) {
    out.put(key);
    out.put(value);
  }
  for (const std::uint32_t number : {element.firstIndex, element.indexCount, element.firstEdge, element.edgeCount})
    out.put(number);
}

DesignElement getElement(Reader& in) {
  DesignElement element;
  for (std::string* text : {&element.globalId, &element.name, &element.type, &element.storey}) *text = in.text();
  element.colour = in.get<Rgba8>();
  for (auto left = in.count(8); left > 0 && in.good(); --left) {
    std::string key = in.text();
    element.properties[std::move(key)] = in.text();
  }
  for (std::uint32_t* number : {&element.firstIndex, &element.indexCount, &element.firstEdge, &element.edgeCount})
    *number = in.get<std::uint32_t>();
  return element;
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// An empty text where the model holds together.
std::string firstFault(const DesignModel& model) {
  if (!finite(model.origin)) return "an origin that is no number";
  for (const glm::vec3& v : model.vertices)
    if (!finite(v)) return "a vertex that is no number";
  const std::size_t vertices = model.vertices.size();
  for (const auto index : model.triangles)
    if (index >= vertices) return "a triangle with a vertex that does not exist";
  for (const auto& edge : model.edges)
    if (edge[0] >= vertices || edge[1] >= vertices) return "an edge with a vertex that does not exist";
  std::uint64_t nextIndex = 0, nextEdge = 0;
  for (const DesignElement& e : model.elements) {
    if (e.indexCount % 3 != 0 || e.firstIndex < nextIndex) return "an element with a wrong range of triangles";
    if (e.firstEdge < nextEdge) return "an element with a wrong range of edges";
    nextIndex = std::uint64_t{e.firstIndex} + e.indexCount;
    nextEdge = std::uint64_t{e.firstEdge} + e.edgeCount;
    if (nextIndex > model.triangles.size()) return "an element with triangles that do not exist";
    if (nextEdge > model.edges.size()) return "an element with edges that do not exist";
  }
  if (model.triangles.size() % 3 != 0) return "a triangle without its third corner";
  return {};
}

}  // namespace

std::vector<std::byte> encodeDesign(const DesignStream& design) {
  Writer out;
  out.put(kMagic);
  out.put(kVersion);
  out.put(design.model.name);
  out.put(design.model.crs);
  out.put(design.model.origin);
  out.putArray(design.model.vertices);
  out.putArray(design.model.triangles);
  out.putArray(design.model.edges);
  out.put(static_cast<std::uint64_t>(design.model.elements.size()));
  for (const DesignElement& element : design.model.elements) putElement(out, element);
  out.put(static_cast<std::uint64_t>(design.notes.size()));
  for (const ConversionNote& note : design.notes) {
    out.put(note.what);
    out.put(note.where);
  }
  return out.take();
}

Result<DesignStream> decodeDesign(std::span<const std::byte> bytes) {
  Reader in(bytes);
  if (in.get<std::uint32_t>() != kMagic || in.get<std::uint32_t>() != kVersion)
    return fail("The converted design is of another kind or version", {}, "Reinstall Alidade");
  DesignStream design;
  design.model.name = in.text();
  design.model.crs = in.text();
  design.model.origin = in.get<glm::dvec3>();
  design.model.vertices = in.array<glm::vec3>();
  design.model.triangles = in.array<std::uint32_t>();
  design.model.edges = in.array<std::array<std::uint32_t, 2>>();
  constexpr std::size_t kLeastElement = 4 * 4 + sizeof(Rgba8) + 8 + 4 * 4;
  for (auto left = in.count(kLeastElement); left > 0 && in.good(); --left)
    design.model.elements.push_back(getElement(in));
  for (auto left = in.count(8); left > 0 && in.good(); --left) {
    ConversionNote note;
    note.what = in.text();
    note.where = in.text();
    design.notes.push_back(std::move(note));
  }
  if (!in.good() || !in.atEnd()) return fail("The converted design is cut off or has bytes left over");
  if (const std::string fault = firstFault(design.model); !fault.empty())
    return fail(fmt::format("The converted design holds {}", fault));
  return design;
}

}  // namespace alidade

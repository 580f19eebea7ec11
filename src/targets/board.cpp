// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/board.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace alidade {

namespace {

constexpr const char* kAdvice =
    "Give chessboard:COLUMNSxROWS:SQUARE with the inner corners and metres (chessboard:8x6:0.025), or "
    "charuco:COLUMNSxROWS:SQUARE:MARKER:DICTIONARY with the squares (charuco:7x5:0.04:0.03:DICT_5X5_100)";

std::vector<std::string> parted(const std::string& text, char by) {
  std::vector<std::string> parts{""};
  for (const char c : text)
    if (c == by) parts.emplace_back();
    else parts.back() += c;
  return parts;
}

template <class Number>
std::optional<Number> numberOf(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

tl::unexpected<Error> wrong(const std::string& what, const std::string& text) {
  return fail(what, text, kAdvice);
}

}  // namespace

Result<Board> Board::parse(const std::string& text) {
  const std::vector<std::string> parts = parted(text, ':');
  Board board;
  if (parts[0] == "charuco") board.kind = BoardKind::Charuco;
  else if (parts[0] != "chessboard") return wrong(fmt::format("There is no board '{}'", parts[0]), text);
  const bool charuco = board.kind == BoardKind::Charuco;
  if (parts.size() != (charuco ? 5u : 3u))
    return wrong(fmt::format("A {} board is said in {} parts, {} were given", parts[0], charuco ? 5 : 3, parts.size()), text);
  const std::vector<std::string> size = parted(parts[1], 'x');
  const auto columns = size.size() == 2 ? numberOf<int>(size[0]) : std::nullopt;
  const auto rows = size.size() == 2 ? numberOf<int>(size[1]) : std::nullopt;
  constexpr int least = 3, most = 100;
  if (!columns || !rows || *columns < least || *rows < least || *columns > most || *rows > most)
    return wrong(fmt::format("The board's size '{}' is not two numbers between {} and {}", parts[1], least, most), text);
  board.columns = *columns, board.rows = *rows;
  const auto length = [](const std::string& number) {
    const auto value = numberOf<double>(number);
    return value && std::isfinite(*value) && *value > 0 && *value < 100 ? *value : 0.0;
  };
  board.squareM = length(parts[2]);
  if (board.squareM == 0) return wrong(fmt::format("The side of a square '{}' is no length in metres", parts[2]), text);
  if (!charuco) return board;
  board.markerM = length(parts[3]);
  if (board.markerM == 0 || board.markerM >= board.squareM)
    return wrong(fmt::format("The side of a marker '{}' is no length in metres below the square's", parts[3]), text);
  board.dictionary = parts[4];
  const auto& known = markerDictionaries();
  if (std::find(known.begin(), known.end(), board.dictionary) == known.end())
    return wrong(fmt::format("There is no marker dictionary '{}'", parts[4]), text);
  const int capacity = numberOf<int>(board.dictionary.substr(board.dictionary.rfind('_') + 1)).value_or(1024);
  if (board.columns * board.rows / 2 > capacity)
    return wrong(fmt::format("The board has {} markers, {} only {}", board.columns * board.rows / 2, board.dictionary, capacity), text);
  return board;
}

std::string Board::text() const {
  if (kind == BoardKind::Chessboard) return fmt::format("chessboard:{}x{}:{}", columns, rows, squareM);
  return fmt::format("charuco:{}x{}:{}:{}:{}", columns, rows, squareM, markerM, dictionary);
}

std::vector<glm::dvec3> Board::corners() const {
  std::vector<glm::dvec3> made;
  for (int r = 0; r < cornerRows(); ++r)
    for (int c = 0; c < cornerColumns(); ++c) made.emplace_back(c * squareM, r * squareM, 0.0);
  return made;
}

}  // namespace alidade

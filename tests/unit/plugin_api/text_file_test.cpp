// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/text_file.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace alidade {

TEST(TextFile, LinesEndInAnyOfTheThreeWays) {
  LineReader lines("a\nb\r\nc\rd\n\ne");
  std::vector<std::string> seen;
  for (std::string_view line; lines.next(line);) seen.emplace_back(line);
  EXPECT_EQ(seen, (std::vector<std::string>{"a", "b", "c", "d", "", "e"}));
  EXPECT_EQ(lines.number(), 6u);
  EXPECT_EQ(lines.fraction(), 1.0);
}

TEST(TextFile, ANumberIsTheWholeField) {
  EXPECT_EQ(parseNumber("1.5"), 1.5);
  EXPECT_EQ(parseNumber("+2e3"), 2000.0);
  EXPECT_EQ(parseNumber("-7"), -7.0);
  EXPECT_TRUE(std::isnan(*parseNumber("nan")));
  EXPECT_TRUE(std::isinf(*parseNumber("1e999")));
  EXPECT_EQ(parseNumber("1e-999"), 0.0);
  for (const char* bad : {"", "+", "+-1", "1.5x", "1,5", " 1", "0x10", "--1"}) EXPECT_FALSE(parseNumber(bad)) << bad;
}

TEST(TextFile, AnIntegerThatOverflowsIsNone) {
  EXPECT_EQ(parseInteger("9223372036854775807"), 9223372036854775807);
  EXPECT_FALSE(parseInteger("9223372036854775808"));
  EXPECT_FALSE(parseInteger("1.0"));
}

TEST(TextFile, TheRestOfALineKeepsItsBlanks) {
  FieldReader fields("  1  2 my picture 3.jpg \r");
  EXPECT_EQ(fields.integer(), 1);
  EXPECT_EQ(fields.number(), 2.0);
  EXPECT_EQ(fields.rest(), "my picture 3.jpg");
}

TEST(TextFile, DropsTheByteOrderMarkAndRefusesWhatNeverEnds) {
  const std::string path = (std::filesystem::temp_directory_path() / "alidade_text_file_test.txt").string();
  std::ofstream(path) << "\xEF\xBB\xBFhello";
  EXPECT_EQ(readTextFile(path), "hello");
  EXPECT_FALSE(readTextFile(path, 3));
  std::filesystem::remove(path);
  EXPECT_FALSE(readTextFile(path));
  EXPECT_FALSE(readTextFile("/dev/zero"));
  EXPECT_FALSE(readTextFile("/tmp"));
}

TEST(TextFile, QuotesAFilesWordsPrintably) {
  EXPECT_EQ(quotedWords("a\tb\x1b"), "'a b '");
  EXPECT_EQ(quotedWords("abcdef", 3), "'abc…'");
}

TEST(TextFile, ARunOfNumbersIsNumbersAloneAndNoMoreThanWanted) {
  EXPECT_EQ(parseNumbers(" 1 -2.5\n3e2\t", 3), (std::vector<double>{1, -2.5, 300}));
  EXPECT_EQ(parseNumbers("", 3), std::vector<double>());
  EXPECT_FALSE(parseNumbers("1 2 3 4", 3));
  EXPECT_FALSE(parseNumbers("1 two", 3));
}

TEST(TextFile, TheDepthOfAJsonTextLeavesOutItsStrings) {
  EXPECT_EQ(jsonDepth(""), 0u);
  EXPECT_EQ(jsonDepth("{\"a\": [1, {}]}"), 3u);
  EXPECT_EQ(jsonDepth("[\"[[[\\\"[[[\", []]"), 2u);
  EXPECT_EQ(jsonDepth("]]]["), 1u);
  EXPECT_EQ(jsonDepth(std::string(1000, '[')), 1000u);
}

}  // namespace alidade

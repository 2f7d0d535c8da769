// SPDX-License-Identifier: BSD-3-Clause
#include "mutator.hpp"

#include <algorithm>

namespace swivel::test {

namespace {

constexpr std::size_t kMostBytes = 1 << 20;

const std::vector<std::string> kNumbers{"0",
                                        "-1",
                                        "1",
                                        "-0.0",
                                        "1e308",
                                        "-1e308",
                                        "1e-308",
                                        "5e-324",
                                        "1e400",
                                        "nan",
                                        "inf",
                                        "-inf",
                                        ".nan",
                                        ".inf",
                                        "0x10",
                                        "1e9",
                                        "1e-9",
                                        "1e16",
                                        "1e160",
                                        "65536",
                                        "2147483647",
                                        "2147483648",
                                        "-2147483649",
                                        "4294967295",
                                        "4294967296",
                                        "9223372036854775807",
                                        "18446744073709551616",
                                        "99999999999999999999999",
                                        "1000",
                                        "1001",
                                        "0.001",
                                        "3.1415926535897931",
                                        "6.2831853",
                                        "1,5",
                                        "1.2.3",
                                        "--1",
                                        "1e",
                                        "",
                                        "x"};
const std::vector<std::string> kPlainNumbers{
    "0",         "1",         "2",      "7",     "10",     "0.1",   "0.01",
    "0.001",     "1e-6",      "1e-9",   "1e-15", "1e-300", "100",   "999",
    "1e4",       "1e6",       "1e9",    "1e16",  "1e160",  "1e308", "3.1415926535897931",
    "6.2831853", "1.5707963", "3.1416", "0.7"};
const std::vector<std::string> kAnyWords{"<",
                                         ">",
                                         "&",
                                         "\"",
                                         "'",
                                         "\\",
                                         "/",
                                         "{",
                                         "}",
                                         "[",
                                         "]",
                                         ",",
                                         ":",
                                         "-",
                                         "#",
                                         "%s",
                                         "\n",
                                         "\r\n",
                                         "\t",
                                         " ",
                                         "<!--",
                                         "-->",
                                         "<![CDATA[",
                                         "&#0;",
                                         "&#x1b;",
                                         "&lt;",
                                         "\x1b[31m",
                                         "\xff",
                                         "\xc3\xa4",
                                         "\xed\xa0\x80",
                                         "\xef\xbb\xbf",
                                         "../",
                                         "/dev/zero",
                                         "null",
                                         "~"};

std::size_t place(const std::string& text, Random& random) {
  return static_cast<std::size_t>(random.below(static_cast<int>(text.size()) + 1));
}

/// Draws a length, mostly of few bytes.
std::size_t length(std::size_t most, Random& random) {
  const int bits = random.below(random.coin(0.2) ? 20 : 6);
  return std::min(most, static_cast<std::size_t>(random.below((1 << bits) + 1)));
}

const std::string& one_of(const std::vector<std::string>& words, Random& random) {
  return words[static_cast<std::size_t>(random.below(static_cast<int>(words.size())))];
}

/// Begin and size of the number after a random place; size 0 where there is none.
std::pair<std::size_t, std::size_t> number(const std::string& text, Random& random) {
  const std::size_t begin = text.find_first_of("0123456789", place(text, random));
  if (begin == std::string::npos) return {0, 0};
  const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-", begin), text.size());
  return {begin, end - begin};
}

/// Begin and size of a line with its end.
std::pair<std::size_t, std::size_t> line(const std::string& text, Random& random) {
  const std::size_t at = place(text, random),
                    before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return {begin, std::min(text.find('\n', begin), text.size() - 1) + 1 - begin};
}

/// Flips one bit of the byte at `at`; the end of the text has none.
void flip_bit(std::string& text, std::size_t at, Random& random) {
  if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << random.below(8)));
}

/// Replaces the byte at `at` by any byte; the end of the text has none.
void replace_byte(std::string& text, std::size_t at, Random& random) {
  if (at < text.size()) text[at] = static_cast<char>(random.below(256));
}

/// Repeats the `size` bytes at `at` side by side.
void repeat(std::string& text, std::size_t at, std::size_t size, Random& random) {
  const std::string part = text.substr(at, std::min<std::size_t>(size, 2000));
  for (std::size_t times = length(300, random) + 1; times > 0; --times) text.insert(at, part);
}

/// Inserts a part of another file at `at`, or puts it in the place of the `size` bytes there.
void splice(std::string& text, std::size_t at, std::size_t size, const std::string& other,
            Random& random) {
  const std::size_t from = place(other, random);
  text.replace(at, random.coin() ? size : 0,
               other.substr(from, length(other.size() - from, random)));
}

/// Inserts the opening word `open` many times at `at`, so that what it opens is nested.
void nest(std::string& text, std::size_t at, const std::string& open, Random& random) {
  std::string many;
  for (std::size_t times = length(20'000, random) + 1; times > 0; --times) many += open;
  text.insert(at, many);
}

/// Overwrites the four bytes at `at` by a binary count, index or number.
void overwrite_count(std::string& text, std::size_t at, Random& random) {
  const std::uint32_t values[] = {0,       1,          0x7fffffff, 0x80000000, 0xffffffff,
                                  0x10000, 0x7f800000, 0x7fc00000, 0x01000000};
  const std::uint32_t value = values[random.below(9)];
  for (std::size_t k = 0; k < 4 && at + k < text.size(); ++k)
    text[at + k] = static_cast<char>(value >> 8 * k);
}

/// Moves a line to another place, or copies it there.
void move_line(std::string& text, Random& random) {
  const auto [a, n] = line(text, random);
  const std::string taken = text.substr(a, n);
  if (random.coin()) text.erase(a, n);
  text.insert(text.empty() ? 0 : line(text, random).first, taken);
}

}  // namespace

std::string Mutator::input(std::uint64_t seed_value) const {
  Random random(seed_value);
  std::string text = one_of(seeds_, random);
  change_some(text, random);
  return text;
}

std::string Mutator::changed(std::string text, std::uint64_t seed_value) const {
  Random random(seed_value);
  change_some(text, random);
  return text;
}

void Mutator::change_some(std::string& text, Random& random) const {
  for (int changes = 1 + random.below(3); changes > 0; --changes) {
    if (text.empty()) text = one_of(kAnyWords, random);
    change(text, random);
    text.resize(std::min(text.size(), kMostBytes));
  }
}

void Mutator::change(std::string& text, Random& random) const {
  const std::size_t at = place(text, random), size = length(text.size() - at, random);
  switch (mild_ ? 10 + random.below(10) : random.below(14)) {
    case 0:
      return flip_bit(text, at, random);
    case 1:
      return replace_byte(text, at, random);
    case 2:
      text.resize(at);
      return;
    case 3:
      text.erase(at, size);
      return;
    case 4:
      return repeat(text, at, size, random);
    case 5:
      return splice(text, at, size, one_of(seeds_, random), random);
    case 6:
      return nest(text, at, one_of(words_, random), random);
    case 7:
      text.insert(at, one_of(words_, random));
      return;
    case 8:
      text.insert(at, one_of(kAnyWords, random));
      return;
    case 9:
      return overwrite_count(text, at, random);
    case 10:
      return move_line(text, random);
    default:  // numbers are what matters most in these formats
    {
      const auto [begin, n] = number(text, random);
      if (n > 0) text.replace(begin, n, one_of(mild_ ? kPlainNumbers : kNumbers, random));
    }
  }
}

}  // namespace swivel::test

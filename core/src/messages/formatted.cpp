// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/core/messages/formatted.hpp"

#include <locale.h>

#include <cstdio>

namespace swivel {

namespace {

/// Gives the calling thread the locale "C" while it lives.
class ClassicLocale {
 public:
  ClassicLocale() : before_(uselocale(classic())) {}
  ~ClassicLocale() { uselocale(before_); }
  ClassicLocale(const ClassicLocale&) = delete;
  ClassicLocale& operator=(const ClassicLocale&) = delete;

 private:
  static locale_t classic() {
    static const locale_t locale = newlocale(LC_ALL_MASK, "C", locale_t{});
    return locale;
  }
  locale_t before_;
};

}  // namespace

std::string formatted_list(const char* format, std::va_list arguments) {
  const ClassicLocale classic;
  std::va_list again;
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  std::string text(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
  if (size > 0) std::vsnprintf(text.data(), text.size() + 1, format, arguments);
  return text;
}

std::string formatted(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string text = formatted_list(format, arguments);
  va_end(arguments);
  return text;
}

std::string percent(double share) {
  return formatted(share < 0.0995 ? "%.2g %%" : "%.0f %%", 100 * share);
}

}  // namespace swivel

/// Preloaded into a program: sets the locale OTHER_LOCALE, as a GUI process would. A missing locale
/// ends the program.
#include <clocale>
#include <cstdio>
#include <cstdlib>

namespace {

[[gnu::constructor]] void set_locale() {
  const char* const name = std::getenv("OTHER_LOCALE");
  if (name != nullptr && std::setlocale(LC_ALL, name) != nullptr) return;
  std::fputs("OTHER_LOCALE names no locale\n", stderr);
  std::abort();
}

}  // namespace

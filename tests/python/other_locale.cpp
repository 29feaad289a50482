/// Preloaded into a program: puts it into the locale that OTHER_LOCALE names, as a process that shows
/// windows would be. One that is not there ends it.
#include <clocale>
#include <cstdio>
#include <cstdlib>

namespace {

[[gnu::constructor]] void take() {
  const char* const name = std::getenv("OTHER_LOCALE");
  if (name != nullptr && std::setlocale(LC_ALL, name) != nullptr) return;
  std::fputs("OTHER_LOCALE names no locale\n", stderr);
  std::abort();
}

}  // namespace

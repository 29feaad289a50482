// Writes the seeds of each target to FOLDER/TARGET/NUMBER. usage: write_seeds FOLDER
#include <filesystem>
#include <fstream>

#include "fuzz/targets.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  for (const trivet::fuzz::Target& target : trivet::fuzz::kTargets) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / target.name;
    std::filesystem::create_directories(folder);
    std::size_t number = 0;
    for (const std::string& seed : target.seeds())
      std::ofstream(folder / std::to_string(number++), std::ios::binary) << seed;
  }
}

// continue_state FMU STATE BEGIN END INTERVAL OUT: restores a serialized state in a process of its own and goes on; the
// outputs at the end go to OUT as bytes.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>

#include "tests/acceptance/fmi/c_importer.h"

int main(int argc, char** argv) {
  using namespace quayside::harness;
  if (argc != 7) return 2;
  try {
    const ImportedFmu fmu(argv[1]);
    std::ifstream file(argv[2], std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    const int begin = std::atoi(argv[3]), end = std::atoi(argv[4]);
    const double interval = std::atof(argv[5]);
    Instance3 instance(fmu);
    instance.initialize();
    instance.restore({text.begin(), text.end()});
    for (int i = begin; i < end; ++i) instance.step(i * interval, (i + 1) * interval);
    const std::vector<double> values = instance.all();
    std::ofstream(argv[6], std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(double)));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}

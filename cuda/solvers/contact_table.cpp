#include "cuda/solvers/contact_table.h"

namespace pliant {

void ContactTable::index(int particles) {
  first.assign(static_cast<std::size_t>(particles), -1);
  touched.clear();
  std::vector<int> counts;
  const auto for_each_corner = [&](const auto& use) {
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      for (int a = 0; a < 4 && contacts[c].particles.v[a] >= 0; ++a) {
        use(contacts[c].particles.v[a], static_cast<int>(4 * c) + a);
      }
    }
  };
  for_each_corner([&](int i, int) {
    int& number = first[static_cast<std::size_t>(i)];
    if (number < 0) {
      number = static_cast<int>(touched.size());
      touched.push_back(i);
      counts.push_back(0);
    }
    ++counts[static_cast<std::size_t>(number)];
  });
  begins.assign(1, 0);
  for (int count : counts) begins.push_back(begins.back() + count);
  entries.resize(static_cast<std::size_t>(begins.back()));
  std::vector<int> next(begins.begin(), begins.end() - 1);
  for_each_corner([&](int i, int entry) {
    int& at = next[static_cast<std::size_t>(first[static_cast<std::size_t>(i)])];
    entries[static_cast<std::size_t>(at++)] = entry;
  });
}

std::vector<int> ContactTable::begins_of_scenes(const std::vector<int>& scene_begins,
                                                int block) const {
  std::vector<int> result;
  std::size_t contact = 0, particle = 0;
  for (int first_block : scene_begins) {
    const int first = first_block * block;
    while (contact < contacts.size() && contacts[contact].particles.v[0] < first) ++contact;
    while (particle < touched.size() && touched[particle] < first) ++particle;
    result.push_back(static_cast<int>(contact));
    result.push_back(static_cast<int>(particle));
  }
  return result;
}

}  // namespace pliant

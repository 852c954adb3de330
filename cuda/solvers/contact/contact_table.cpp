#include "cuda/solvers/contact/contact_table.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"

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
  begins_of_scenes = {0, 0, static_cast<int>(contacts.size()), static_cast<int>(touched.size())};
}

namespace {

/// Copies a scene's table to its place in `joined`, whose arrays are large enough.
void copy_scene(const ContactTable& own, std::size_t scene, int first_place, ContactTable& joined) {
  const auto contact = static_cast<std::size_t>(joined.begins_of_scenes[2 * scene]);
  const auto particle = static_cast<std::size_t>(joined.begins_of_scenes[2 * scene + 1]);
  for (std::size_t c = 0; c < own.contacts.size(); ++c) {
    DeviceContact moved = own.contacts[c];
    for (int& place : moved.particles.v) place += place >= 0 ? first_place : 0;
    joined.contacts[contact + c] = moved;
    joined.forces[contact + c] = own.forces[c];
  }
  if (own.contacts.empty()) return;
  const int entry = joined.begins[particle];
  for (std::size_t k = 0; k < own.touched.size(); ++k) {
    joined.touched[particle + k] = first_place + own.touched[k];
    joined.begins[particle + k] = entry + own.begins[k];
  }
  for (std::size_t k = 0; k < own.entries.size(); ++k) {
    joined.entries[static_cast<std::size_t>(entry) + k] =
        own.entries[k] + 4 * static_cast<int>(contact);
  }
  for (std::size_t k = 0; k < own.first.size(); ++k) {
    if (own.first[k] < 0) continue;
    joined.first[static_cast<std::size_t>(first_place) + k] =
        own.first[k] + static_cast<int>(particle);
  }
}

}  // namespace

void join(const std::vector<const ContactTable*>& tables, const std::vector<int>& first_places,
          ContactTable& joined) {
  std::size_t contacts = 0, particles = 0, entries = 0;
  joined.embedded = false;
  joined.begins_of_scenes.assign(1, 0);
  joined.begins_of_scenes.push_back(0);
  std::vector<std::size_t> first_entries;
  for (const ContactTable* table : tables) {
    first_entries.push_back(entries);
    const bool any = !table->contacts.empty();  // else its index is of an earlier step
    contacts += table->contacts.size();
    particles += any ? table->touched.size() : 0;
    entries += any ? table->entries.size() : 0;
    joined.embedded = joined.embedded || table->embedded;
    joined.begins_of_scenes.push_back(static_cast<int>(contacts));
    joined.begins_of_scenes.push_back(static_cast<int>(particles));
  }
  joined.contacts.resize(contacts);
  joined.forces.resize(contacts);
  joined.touched.resize(particles);
  joined.begins.resize(particles + 1);
  joined.begins[particles] = static_cast<int>(entries);
  joined.entries.resize(entries);
  joined.first.resize(static_cast<std::size_t>(first_places.back()));
  for (std::size_t s = 0; s < tables.size(); ++s) {
    joined.begins[static_cast<std::size_t>(joined.begins_of_scenes[2 * s + 1])] =
        static_cast<int>(first_entries[s]);
  }
  joined.begins[particles] = static_cast<int>(entries);
  parallel_for(0, static_cast<int>(tables.size()), 16, [&](int begin, int end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      std::fill(joined.first.begin() + first_places[s], joined.first.begin() + first_places[s + 1],
                -1);
      copy_scene(*tables[s], s, first_places[s], joined);
    }
  });
}

}  // namespace pliant

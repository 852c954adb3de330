#include <kdl_parser/kdl_parser.hpp>

#include "pliant/scene/robot_library.h"

extern "C" bool pliant_robot_tree(const urdf::ModelInterface& model, KDL::Tree& tree) {
  return kdl_parser::treeFromUrdfModel(model, tree);
}

#include "pliant/ros/model_node.h"

int main(int argc, char** argv) {
  return pliant::run_model_node(argc, argv, "cloth", "demo_cloth.yaml");
}

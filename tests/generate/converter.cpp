// Data of an event through the converter that the program has registered.
#include "joint_angles.hpp"
#include <iostream>

int main()
{
    joint_angles::register_converter();
    const auto found = rsb::converter::converterRepository<std::string>()->known.at(".rst.kinematics.JointAngles");
    const auto angles = boost::make_shared<rst::kinematics::JointAngles>();
    angles->add_angles(0.5F);
    angles->add_angles(-2.0F);
    std::string wire;
    std::cout << found->serialize(rsb::AnnotatedData(found->getDataType(), angles), wire) << ' ' << (wire == angles->SerializeAsString()) << '\n';
    const auto again = found->deserialize(found->getWireSchema(), wire);
    std::cout << again.first << ' ' << boost::static_pointer_cast<rst::kinematics::JointAngles>(again.second)->angles(1) << '\n';
}

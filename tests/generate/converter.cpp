// Data of an event through the converter that the program has registered, which is found as RSB finds it.
#include HEADER
#include <iostream>

using rst::kinematics::JointAngles;

template <class Call> void refused(const Call &call)
{
    try {
        call();
        std::cout << "taken\n";
    } catch (const rsb::converter::SerializationException &found) {
        std::cout << found.what() << '\n';
    }
}

int main(int, char **arguments)
{
    NAME::register_converter();
    const std::string schema = arguments[1];
    const auto found = rsb::converter::converterRepository<std::string>()->known.at({schema, rsc::runtime::typeName<JointAngles>()});
    const auto angles = boost::make_shared<JointAngles>();
    for (const float angle : {0.5F, 0.25F, -2.0F}) {
        angles->add_angles(angle);
    }
    std::string wire;
    std::cout << found->serialize(rsb::AnnotatedData(found->getDataType(), angles), wire) << ' ' << (wire == angles->SerializeAsString()) << '\n';
    const auto again = found->deserialize(schema, wire);
    std::cout << again.first << ' ' << boost::static_pointer_cast<JointAngles>(again.second)->angles(2) << '\n';
    refused([&] { found->deserialize(schema, wire.substr(0, wire.size() - 1)); });
    angles->Clear();
    refused([&] { found->serialize(rsb::AnnotatedData(found->getDataType(), angles), wire); });
}

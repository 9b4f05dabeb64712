#pragma once
#include <map>
#include <rsb/converter/Converter.h>
#include <stdexcept>

namespace rsb::converter {
template <class Wire> class Repository {
public:
    typedef boost::shared_ptr<Repository<Wire>> Ptr;
    void registerConverter(typename Converter<Wire>::Ptr converter, bool replace = false)
    {
        const auto key = std::make_pair(converter->getWireSchema(), converter->getDataType());
        if (known.count(key) && !replace) {
            throw std::invalid_argument(key.first);
        }
        known[key] = converter;
    }
    std::map<std::pair<std::string, std::string>, typename Converter<Wire>::Ptr> known;
};

template <class Wire> typename Repository<Wire>::Ptr converterRepository()
{
    static const typename Repository<Wire>::Ptr repository(new Repository<Wire>);
    return repository;
}
} // namespace rsb::converter

"""The language of bottle schemas: what a bottle of YARP holds, from the text of a `.bottle-schema` file to the meta-model."""

"""Plain TCP, Unix and UDP sockets, pipes and files: messages with their length before them, a line each, or a datagram each."""

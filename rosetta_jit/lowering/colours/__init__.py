"""Pixels as cameras send them, made RGB: mosaics of Bayer filters, and YUV with a pair of chroma values for several pixels. RGB made YUV.

Encodings have ROS's names (sensor_msgs/image_encodings.h), and all have 8 bits. Where c(x) is x, at least 0 and at most 255:

    YUV      y = 1220542 * max(Y - 16, 0) + 2**19, u = U - 128, v = V - 128            BT.601, limited range, times 2**20
             R = c((y + 1673527 * v) >> 20)   G = c((y - 852492 * v - 409993 * u) >> 20)   B = c((y + 2116026 * u) >> 20)
    mosaics  a colour that a pixel lacks is the mean of the 2 or 4 nearest that have it: (a + b + 1) >> 1, (a + b + c + d + 2) >> 2.
             Beyond the border the image goes on as its mirror: row -1 is row 1.
    to YUV   Y = (269484 * R + 528482 * G + 102760 * B + 33 * 2**19) >> 20, U = (460324 * B - 155188 * R - 305135 * G + 257 * 2**19) >> 20
             V = (460324 * R - 385875 * G - 74448 * B + 257 * 2**19) >> 20: of the mean of a pair of pixels where each pair has its chroma,
             of the left upper pixel where four have

That is what OpenCV computes, but for mosaics' outermost pixels. A row's place is checked before its pixels are read, so that all
other arithmetic is linear.
"""

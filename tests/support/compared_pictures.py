"""Pictures that are compared by structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004)."""

import numpy
from skimage import io as image_io
from skimage.color import rgb2gray
from skimage.metrics import structural_similarity
from skimage.transform import resize

# Pictures are compared at this width: a text that is set by another font or a line that is smoothed in another way then changes little.
COMPARED_WIDTH = 350


def grey(pixels):
    """Returns a picture of the compared width, 0 to 1, of the file or buffer of a picture in colour."""
    colours = image_io.imread(pixels, plugin="pil")[..., :3]
    height = round(colours.shape[0] * COMPARED_WIDTH / colours.shape[1])
    return resize(rgb2gray(colours), (height, COMPARED_WIDTH), anti_aliasing=True)


def read(file):
    """Returns a picture that save() has written."""
    return image_io.imread(file, plugin="pil") / 255.0


def save(file, picture):
    image_io.imsave(file, numpy.round(255 * picture).astype(numpy.uint8), plugin="pil", check_contrast=False)


def similarity(picture, other):
    """Returns 1 for equal pictures of one size, less the less similar they are."""
    return structural_similarity(picture, other, data_range=1.0)

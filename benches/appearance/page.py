def write(results, pictures, docs):
    pass
